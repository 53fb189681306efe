"""A scene that is ready to be traced: its triangles, materials and lights on the device, and the intersector."""

from __future__ import annotations

import moderngl
from numpy.typing import NDArray

from ...gpu.context import Context
from ...gpu.programs import set_uniform
from ...material.weave import WeaveBinding
from ...plan.bsdf_switches import bsdf_switches
from ...scene.fibre import gives_color, hair_fibre
from ...scene.fog import fog_of
from ...scene.medium import VACUUM
from ...scene.scene import Scene
from ...scene.volume import volume_medium
from ...scene.woven import woven
from ...scene.yarn.spun import spun
from ...settings import Settings
from ..plan import TracePlan, plan_trace
from ..rays.intersect import EMBREE_TRIANGLES, make_intersector
from .caustic_guide import CausticGuide, guides, may_guide
from .curves import trace_curves
from .encode import geometry_switches
from .geometry import trace_geometry
from .inside import solids_around
from .lights import SceneLights
from .nested import with_priorities
from .photons import Photons
from .scene_buffer import SceneBufferBuilder
from .scene_data import SceneData
from .volumes import VolumeGrids

UNIT_WEAVE = 22  # beyond that of viewer/trace/scene/volumes.py


class TracedScene:
    """Begins with the lights of `scene` under `settings`. `relight` changes to other lights on the same triangles.
    With `is_for_photons` none but photons are traced, which have no guide to caustics."""

    def __init__(self, context: Context, scene: Scene, settings: Settings, intersector: str,
                 is_for_photons: bool) -> None:
        self._context, self.is_for_photons = context, is_for_photons
        self._fog = fog_of(scene, settings)
        self._placed = trace_geometry(scene, fog=self._fog, curves=trace_curves(scene))
        self.geometry = with_priorities(self._placed)
        self.is_everything = settings.plan == "everything"
        self._data = SceneData(context, scene, self.geometry, self.is_everything)
        self._grids: VolumeGrids | None = None
        self._weave = WeaveBinding(context.gl)
        self._take_volumes(scene)
        self.intersector = make_intersector(context, self.geometry, self._data, intersector)
        self._set_lights(scene, settings, None, None)

    def holds(self, scene: Scene) -> bool:
        """Whether these are the triangles and materials of that scene. Its lights may differ."""
        return scene.has_surfaces_of(self._scene)

    def has_fog_of(self, scene: Scene, settings: Settings) -> bool:
        """Whether these settings ask for the same fog about that scene."""
        return fog_of(scene, settings) == self._fog

    def move(self, scene: Scene, settings: Settings) -> bool:
        """Take another scene, such as another pose, or fog. Returns False if it needs other textures or programs."""
        fog = fog_of(scene, settings)
        curves = trace_curves(scene, (self._scene, self.geometry.curves))
        placed = trace_geometry(scene, (self._scene, self._placed), fog=fog, curves=curves)
        geometry = with_priorities(placed)
        is_huge = geometry.triangle_count > max(EMBREE_TRIANGLES, self.geometry.triangle_count)
        if is_huge or not self._data.fits(scene, geometry):
            return False
        self._placed, self.geometry, self._fog = placed, geometry, fog
        self._data.take(scene, geometry)
        if scene.volumes != self._scene.volumes:
            self._take_volumes(scene)
        self.intersector.move(geometry)
        self._set_lights(scene, settings, self._lights, self._guide)
        return True

    def relight(self, scene: Scene, settings: Settings) -> None:
        """Take the lights of a scene for which `holds` is true."""
        if _light_key(scene, settings) != self._light_key:
            self._set_lights(scene, settings, self._lights, self._guide)
        self._scene = scene

    def _take_volumes(self, scene: Scene) -> None:
        if self._grids is not None:
            self._grids.release()
        self._grids = VolumeGrids(self._context.gl, scene) if scene.volumes else None

    def _set_lights(self, scene: Scene, settings: Settings, lights: SceneLights | None,
                    guide: CausticGuide | None) -> None:
        """`lights` and `guide` are those before."""
        buffer = self._data.buffer.copy()
        self._lights = SceneLights(self._context, scene, self.geometry, buffer, settings, lights)
        if self._grids is not None:
            buffer.add("volumes", self._grids.records(scene, volume_medium(settings)))
        if self.geometry.curves is not None:
            for name, texels in self.geometry.curves.texels(settings).items():
                buffer.add(name, texels)
        self.photons = Photons(scene, self.geometry, buffer, settings, self._lights.lit)
        self._guide = CausticGuide(scene, self.geometry, buffer, self._lights, self.intersector, guide,
                                   is_wanted=guides(settings) and not self.is_for_photons)
        self._data.upload(buffer)
        self._data.show_specular(bool(bsdf_switches(settings)["SHOW_SPECULAR"]))
        self._scene, self._droplets = scene, _droplets(scene, settings)
        self._light_key: tuple[object, ...] = _light_key(scene, settings)

    @property
    def switches(self) -> dict[str, int]:
        """The defines that say which features of surfaces and lights the scene has."""
        return self._data.switches | self._lights.switches | self._guide.switches | self._droplets

    def media_uniforms(self, eye: NDArray | None) -> dict[str, object]:
        """The uniforms of media and of those around `eye`, (3,) in tracer space; None: it has no place."""
        geometry = self.geometry
        if not (geometry.scatters or geometry.indices):
            return {}
        nesting = geometry.nesting
        around = [] if eye is None else solids_around(geometry, eye)
        if geometry.indices:
            around.sort(key=lambda instance: instance.medium)
        material = geometry.materials[around[-1].material] if around else None
        ior = max(material.material.ior, 1.0) if material is not None and material.transmits else 1.0
        return {**nesting.uniforms, "u_camera_medium": nesting.of(instance.medium for instance in around),
                "u_camera_eta2": ior * ior}

    def is_background_smooth(self, pixel_angle: float) -> bool:
        """As `SceneLights.is_background_smooth`."""
        return self._lights.is_background_smooth(pixel_angle)

    @property
    def background_rows(self) -> int:
        """As `SceneLights.background_rows`."""
        return self._lights.background_rows

    @property
    def left_out(self) -> list[str]:
        """Lines for the user about lights that have no effect and maps at reduced size."""
        return [*self._lights.left_out, *self._data.warnings]

    @property
    def texture_bytes(self) -> int:
        """About the size of the scene's textures on the GPU."""
        return self._data.texture_bytes + (self._grids.texture_bytes if self._grids is not None else 0)

    def use_textures(self) -> None:
        """Bind the textures to their units."""
        self._data.use_textures()
        self._lights.use_textures()
        self._weave.use(UNIT_WEAVE)
        if self._grids is not None:
            self._grids.use_textures()

    def set_uniforms(self, program: moderngl.Program) -> None:
        """Set the uniforms that do not depend on the picture."""
        self._data.set_uniforms(program)
        self._lights.set_uniforms(program)
        for name, value in {**self.photons.uniforms, **self._guide.uniforms}.items():
            set_uniform(program, name, value)
        woven = (m.material.weave for m in self.geometry.materials if m.material.weave is not None)
        self._weave.bind(program, next(woven, None), UNIT_WEAVE)
        if self._grids is not None:
            self._grids.set_uniforms(program)

    def release(self) -> None:
        self._data.release()
        self._lights.release()
        self._weave.release()
        if self._grids is not None:
            self._grids.release()


def _light_key(scene: Scene, settings: Settings) -> tuple[object, ...]:
    """What the lights depend on. Environments are compared by identity."""
    fibres = (hair_fibre(settings), gives_color(settings)) if scene.curves else None
    return (scene.environment, scene.lights, settings.light_radius, settings.lobes,
            settings.background_blur, settings.caustics, volume_medium(settings), fibres, guides(settings))


def _droplets(scene: Scene, settings: Settings) -> dict[str, int]:
    """The switch of droplets' phase function."""
    volume = volume_medium(settings) if scene.volumes else VACUUM
    fog = fog_of(scene, settings)
    return {"HAS_DROPLETS": int(volume.droplet_diameter > 0 or (fog is not None and fog.medium.droplet_diameter > 0))}


def plan_without_device(scene: Scene, settings: Settings, rays: int = 0) -> TracePlan:
    """The plan of a picture without layers; it needs no context. `rays` are those of `plan_trace`. A guide to caustics
    is planned where there may be one, since no photons look for it. Raises InputError as `SceneLights` does."""
    scene = spun(woven(scene, settings), settings)
    geometry = with_priorities(trace_geometry(scene, fog=fog_of(scene, settings), curves=trace_curves(scene)))
    switches = geometry_switches(scene, geometry, settings.plan == "everything")
    buffer = SceneBufferBuilder()
    lights = SceneLights(None, scene, geometry, buffer, settings)
    photons = Photons(scene, geometry, buffer, settings, lights.lit)
    switches |= lights.switches | _droplets(scene, settings)
    switches["HAS_CAUSTIC_GUIDE"] = int(guides(settings) and may_guide(scene, geometry, lights))
    return plan_trace(scene, settings, geometry, switches,
                      has_layers=settings.denoise != "off", left_out=lights.left_out, rays=rays, photons=photons,
                      intersector="Embree where OpenGL is software, a BVH in a shader elsewhere")
