"""Makes dfg_ggx_smith.npy, the DFG table of the default lobe: python assets/make_dfg.py (a few seconds)."""

from pathlib import Path

import numpy as np

from viewer.bake.dfg import SIZE, compute_dfg_table

if __name__ == "__main__":
    np.save(Path(__file__).with_name("dfg_ggx_smith.npy"), compute_dfg_table("ggx", "smith", SIZE, nodes=64))
