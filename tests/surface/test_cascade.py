import itertools
import math

import numpy as np
import pytest

from jaxocean.surface import Cascade


def test_default_bands_join_without_gap_from_the_first_cell_to_the_last_nyquist():
    cascade = Cascade()
    edges = [math.pi / 893, *(math.pi * 256 / size for size in (893, 101, 21, 11))]
    np.testing.assert_allclose(cascade.bands, list(itertools.pairwise(edges)))
    assert cascade.wavenumber_limit == pytest.approx(math.pi * 256 / 11)
    assert cascade.band == (cascade.bands[0][0], cascade.bands[3][1])


def test_a_larger_pattern_carries_longer_waves_whatever_the_order():
    forward, backward = Cascade((300, 40, 9)), Cascade((9, 300, 40))
    assert backward.bands == (forward.bands[2], forward.bands[0], forward.bands[1])


@pytest.mark.parametrize(
    ("sizes", "period"),
    [((893, 101, 21, 11), 893 * 101 * 21 * 11), ((6, 4), 12), ((0.5, 0.75), 1.5), ((10.1, 2.02), 10.1)],
)
def test_period_is_the_least_common_multiple_of_the_sizes(sizes, period):
    assert Cascade(sizes, 64).period == pytest.approx(period, rel=1e-15)


def test_equal_cascades_are_equal_and_hash_alike():
    one = Cascade((100, 10), 64)
    assert one == Cascade([100.0, 10.0], 64, bands=one.bands)
    assert hash(one) == hash(Cascade((100.0, 10.0), 64))
    assert one != Cascade((100, 10), 32)
    with pytest.raises(AttributeError):
        one.resolution = 128


def test_points_lie_on_the_rest_plane_with_x_along_the_last_axis():
    points = Cascade((100, 10), 20).points(1)
    assert points.shape == (20, 20, 2)
    np.testing.assert_allclose(points[3, 7], [3.5, 1.5])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ({"sizes": (-5.0, 10.0)}, "sizes.*greater than 0 m, but holds -5"),
        ({"sizes": (math.nan,)}, "sizes.*finite"),
        ({"sizes": ()}, "1 to 16 sizes, but holds 0"),
        ({"sizes": tuple(range(1, 18))}, "1 to 16 sizes, but holds 17"),
        ({"sizes": (10, 10)}, "10 m is there twice"),
        ({"resolution": 255}, "even whole number from 8 to 4096, but is 255"),
        ({"resolution": 6}, "but is 6"),
        ({"resolution": 8192}, "but is 8192"),
        ({"resolution": True}, "but is True"),
        ({"sizes": (1000.0, 0.1), "resolution": 8}, "raise the resolution"),
        ({"sizes": (100, 10), "bands": [(0.1, 1.0)]}, "one \\(lower, upper\\) for each of the 2 sizes"),
        ({"sizes": (100, 10), "bands": [(0.1, 1.0), (1.0, 1.0)]}, "empty or invalid band"),
        ({"sizes": (100, 10), "bands": [(0.1, 1.0), (math.nan, 2.0)]}, "empty or invalid band"),
        ({"sizes": (100, 10), "bands": [(0.1, 1.0), (0.9, 2.0)]}, "must not overlap"),
        ({"sizes": (100, 10), "bands": [(0.1, 1.0), (1.1, 2.0)]}, "leave no gap"),
        ({"sizes": (100, 10), "bands": [(0.1, 9.0), (9.0, 20.0)]}, "100 m at resolution 256 must carry"),
        ({"sizes": (100,), "bands": [(0.1, 1.0, 2.0)]}, "3 numbers"),
    ],
)
def test_a_cascade_that_makes_no_sense_is_refused_with_a_reason(arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        Cascade(**arguments)
