"""USD: .usd, .usda, .usdc and .usdz.

OpenUSD reads the files in another process (viewer/base/apart.py): `stage.py` and what it imports run there, and return
plain arrays and JSON. `load.py` and `materials.py` make a Scene of that.
"""
