import numpy as np

from viewer.scene.color import linear_to_srgb, srgb_to_linear


def test_known_values():
    # IEC 61966-2-1: the pieces meet near 0.04045; middle grey of 8 bits is 0.21586.
    np.testing.assert_allclose(srgb_to_linear([0, 0.04045, 128 / 255, 1]), [0, 0.0031308, 0.215861, 1], atol=1e-6)


def test_round_trip():
    values = np.linspace(0, 1, 1001)
    np.testing.assert_allclose(linear_to_srgb(srgb_to_linear(values)), values, atol=1e-7)
