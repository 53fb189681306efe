"""Makes dfg_ggx_smith.npy, the DFG table of the default lobe, and dfg_ggx_smith_stretched.npz, what it lacks where
anisotropy stretches the lobe: python assets/make_dfg.py (two minutes)."""

from pathlib import Path

import numpy as np

from viewer.bake.dfg import SIZE, compute_dfg_table
from viewer.bake.stretched import compute_levels

if __name__ == "__main__":
    folder = Path(__file__).parent
    np.save(folder / "dfg_ggx_smith.npy", compute_dfg_table("ggx", "smith", SIZE, nodes=64))
    albedos, means = compute_levels("smith", nodes=96)
    np.savez_compressed(folder / "dfg_ggx_smith_stretched.npz", albedos=albedos, means=means)
