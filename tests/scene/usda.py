"""Texts of USD files for tests."""

from __future__ import annotations

SQUARE = """int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        uniform token subdivisionScheme = "none"
"""
"""In the plane z = 0; seen from +z it is counter-clockwise."""


def stage(body: str, head: str = "", meters: float = 1, up: str = "Y") -> str:
    return f'#usda 1.0\n(\n    metersPerUnit = {meters}\n    upAxis = "{up}"\n{head}\n)\n{body}\n'


def mesh(more: str = "", name: str = "Square", body: str = SQUARE, meta: str = "") -> str:
    return f'def Mesh "{name}" ({meta})\n{{\n        {body}\n        {more}\n}}\n'


def material(inputs: str, shaders: str = "", name: str = "Paint") -> str:
    return f"""def Material "{name}"
{{
    token outputs:surface.connect = </{name}/Surface.outputs:surface>
    def Shader "Surface"
    {{
        uniform token info:id = "UsdPreviewSurface"
        {inputs}
        token outputs:surface
    }}
    def Shader "Reader"
    {{
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "map1"
        float2 outputs:result
    }}
    {shaders}
}}
"""


def texture(name: str, file: str, more: str = "", material: str = "Paint", reader: str = "Reader") -> str:
    return f"""def Shader "{name}"
    {{
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @{file}@
        float2 inputs:st.connect = </{material}/{reader}.outputs:result>
        token inputs:wrapS = "repeat"
        {more}
        float outputs:r
        float outputs:g
        float outputs:a
        float3 outputs:rgb
    }}
"""


BOUND = """rel material:binding = </Paint>
        texCoord2f[] primvars:map1 = [(0, 0), (1, 0), (1, 1), (0, 1)] ( interpolation = "vertex" )"""
APPLIED = 'prepend apiSchemas = ["MaterialBindingAPI"]'
