"""Objects of the wrong kind are refused where they are given, with a sentence that names the argument."""

import os
import subprocess
import sys
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import jaxocean as jo

# A user has no type checker at run time, the tests have one: so these run in a process without it.
CALLS = {
    'jo.Wind(5.0, drag="wu")': "Argument `drag` must be a drag law such as `ElfouhailyDrag()`",
    "jo.spectra.Elfouhaily(10.0)": "Argument `wind` must be a `Wind`, but is 10.0.",
    "jo.whitecaps.laws.Monahan1980()(10.0)": "Argument `wind` must be a `Wind`, but is 10.0.",
    "jo.surface.realise(cascade, spectrum, key=key)": "Argument `spectrum` must be a spectrum such as",
    'jo.Ocean(sea=sea, closure="exact")': "Argument `closure` must be a closure such as `ExactClosure()`",
    'fitting.fit(1.0, [], [], solver="lm")': "Argument `solver` must be a solver such as",
    "fitting.CoverageLaw(jo.whitecaps.laws.Monahan1980, [4.0])": "but is the class Monahan1980 itself.",
    "jo.surface.Cascade(100.0, 64)": "Argument `sizes` must hold one size [m] per pattern, but is 100.0",
    "sea.height(np.zeros((2, 3)), 0.0)": "Argument `p` must hold places (x, y) on its last axis, but has shape (2, 3).",
    "sea.fields(jax.numpy.arange(3.0))": "Argument `time` must be one number, but has shape (3,)",
    'draw(method="rays")': "Argument `method` must be `Raster()` or `Rays()`, but is 'rays'.",
    "draw(method=jo.render.Rays)": "but is the class Rays itself.",
    "draw(camera=(0.0, 0.0, 10.0))": "Argument `camera` must be a `Camera`, but is a tuple.",
    "draw(ocean=sea)": "Argument `ocean` must be an `Ocean`, but is a Sea.",
    "draw(size=(10.5, 10))": "`size` must be (rows, columns) with 1 to 16384 whole pixels each, but is (10.5, 10).",
    "draw(size=10)": "whole pixels each, but is 10.",
    "draw(curvature=-1)": "Argument `curvature` must be at least 0 1/m, but is -1.",
    "jo.Ocean(sea, unresolved=2.0)": "Argument `unresolved` must be a spectrum such as `Elfouhaily(wind)`, but is 2.0.",
    "jo.whitecaps.jacobian(jax.numpy.zeros((4, 2)))": "Argument `strain` must hold (a, b, c) on its last axis",
}

PROGRAM = """
import sys, jax, numpy as np, jaxocean as jo, fitting
key = jax.random.key(0)
cascade = jo.surface.Cascade((50.0,), 16)
spectrum = jo.spectra.Elfouhaily(jo.Wind(8.0))
sea = jo.surface.realise(spectrum, cascade, key=key)
def draw(**changed):
    given = {"ocean": jo.Ocean(sea), "camera": jo.render.Camera((0.0, 0.0, 10.0)), "time": 0.0, "size": (2, 2)}
    return jo.render.render(**{**given, **changed})
for call in sys.argv[1:]:
    try:
        eval(call)
        print("nothing was raised")
    except ValueError as error:
        print(str(error).replace(chr(10), " "))
"""


@pytest.fixture(scope="module")
def answers():
    environment = {**os.environ, "PYTHONPATH": str(Path(jo.__file__).parents[1])}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *CALLS], capture_output=True, text=True, env=environment, check=False
    )
    assert done.returncode == 0, done.stderr
    return dict(zip(CALLS, done.stdout.splitlines(), strict=True))


@pytest.mark.parametrize("call", CALLS)
def test_wrong_kinds_of_arguments_are_named(answers, call):
    assert CALLS[call] in answers[call]


def test_points_may_be_lists():
    sea = jo.surface.realise(
        jo.spectra.Elfouhaily(jo.Wind(8.0)), jo.surface.Cascade((50.0,), 16), key=jax.random.key(0)
    )
    places = np.array([[10.0, 20.0]])
    np.testing.assert_array_equal(sea.height(places, 0.0), sea.height(jnp.asarray(places), 0.0))


def test_a_breaking_wavenumber_that_strays_is_no_number():
    spectrum = jo.spectra.Elfouhaily(jo.Wind(8.0))

    @jax.jit
    def variance(limit):
        stats = jo.whitecaps.strain_statistics(spectrum, band=(0.01, 10.0), breaking_wavenumber=limit)
        return stats.covariance[0, 0]

    assert np.isnan(variance(-1.0))
    assert variance(1.0) > 0
    with pytest.raises(ValueError, match="`breaking_wavenumber` must be greater than 0 rad/m, but is -1"):
        jo.whitecaps.strain_statistics(spectrum, band=(0.01, 10.0), breaking_wavenumber=-1.0)


def test_spectra_sum_and_divide_like_numbers():
    spectrum = jo.spectra.Elfouhaily(jo.Wind(8.0))
    k = jnp.array(0.3)
    np.testing.assert_allclose(sum([spectrum, spectrum])(k, k), 2 * spectrum(k, k))
    np.testing.assert_allclose((spectrum / 4)(k, k), spectrum(k, k) / 4)
