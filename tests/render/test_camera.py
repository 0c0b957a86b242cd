"""The camera: its axes, its rays and its projection agree; nonsense is refused."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _derivatives import assert_gradient_matches

import jaxocean as jo
from jaxocean.render import Camera, check_above
from jaxocean.render._bounds import highest_over
from jaxocean.surface.fft._points import reduce_points

SIZE = (90, 160)


def camera(**changes):
    given = {"heading": 0.7, "pitch": 0.4, "field_of_view": 1.1, "roll": 0.3}
    return Camera((10.0, -20.0, 30.0), **{**given, **changes})


def test_a_point_on_a_pixels_ray_is_projected_to_that_pixels_centre():
    view = camera()
    rays = view.rays(SIZE)
    distance = np.random.default_rng(0).uniform(1, 1e4, SIZE)[..., None]
    pixel, ahead = view.project(view.position + distance * rays, SIZE)
    column, row = np.meshgrid(np.arange(160) + 0.5, np.arange(90) + 0.5)
    np.testing.assert_allclose(pixel[..., 0], column, atol=1e-8)
    np.testing.assert_allclose(pixel[..., 1], row, atol=1e-8)
    np.testing.assert_allclose(ahead, (distance * rays)[..., :] @ view.axes()[2], rtol=1e-12)


def test_the_axes_are_a_right_handed_orthonormal_frame():
    axes = np.asarray(camera().axes())
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(np.cross(axes[0], axes[1]), -axes[2], atol=1e-14)


def test_an_upright_camera_has_the_sky_above_and_the_right_hand_on_the_right():
    view = Camera((0.0, 0.0, 5.0), heading=0.0, pitch=0.0)
    rays = np.asarray(view.rays((3, 3)))
    assert rays[0, 1, 2] > 0 > rays[2, 1, 2]
    assert rays[1, 0, 1] > 0 > rays[1, 2, 1]  # looking along +x, +y is on the left


def test_the_field_of_view_is_the_angle_between_the_upper_and_the_lower_edge():
    view = camera(field_of_view=1.2)
    height = SIZE[0] / 2 / np.tan(0.6)
    np.testing.assert_allclose(view.focal_length(SIZE), height)


def test_a_target_is_seen_in_the_middle_of_the_image():
    target = jnp.array([-3.0, 8.0, 1.0])
    view = Camera.look_at((10.0, -20.0, 30.0), target, roll=0.4)
    pixel, _ = view.project(target, SIZE)
    np.testing.assert_allclose(pixel, [80.0, 45.0], atol=1e-9)


def test_a_target_straight_below_is_seen_too():
    view = Camera.look_at((1.0, 2.0, 30.0), (1.0, 2.0, 0.0))
    np.testing.assert_allclose(view.axes()[2], [0, 0, -1], atol=1e-12)


def test_the_derivative_of_the_projection_is_right():
    def place(x):
        view = Camera(x[:3], heading=x[3], pitch=x[4], field_of_view=x[5], roll=x[6])
        return jnp.sum(view.project(jnp.array([50.0, 30.0, 2.0]), SIZE)[0])

    assert_gradient_matches(place, [[10.0, -20.0, 30.0, 0.7, 0.4, 1.1, 0.3]], rtol=1e-6)


@pytest.mark.parametrize("dtype", [jnp.float32, jnp.float64])
@pytest.mark.parametrize("pitch", [1.5708, -1.5708, 1.571])
def test_straight_down_and_up_may_be_rounded_and_keep_their_derivative(dtype, pitch):
    view = Camera((0.0, 0.0, 9.0), pitch=jnp.asarray(pitch, dtype)).astype(dtype)
    assert abs(float(view.pitch)) == pytest.approx(np.pi / 2, abs=1e-7)
    np.testing.assert_allclose(view.axes()[2], [0, 0, -np.sign(pitch)], atol=1e-6)
    slope = jax.grad(lambda x: Camera((0.0, 0.0, 9.0), pitch=x).axes()[2, 0])(jnp.asarray(np.pi / 2))
    np.testing.assert_allclose(slope, -1.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"field_of_view": 0.0}, "field_of_view"),
        ({"field_of_view": 3.2}, "field_of_view"),
        ({"pitch": 1.7}, "pitch"),
        ({"heading": float("nan")}, "heading"),
    ],
)
def test_a_camera_that_makes_no_sense_is_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        camera(**changes)


def test_a_position_that_is_not_finite_is_refused():
    with pytest.raises(ValueError, match="position"):
        Camera((0.0, 0.0, float("inf")))
    with pytest.raises(ValueError, match="target"):
        Camera.look_at((1.0, 2.0, 3.0), (1.0, 2.0, 3.0))


@pytest.mark.parametrize("size", [(0, 10), (10, 0), (10, 100000)])
def test_an_image_without_pixels_or_with_too_many_is_refused(size):
    with pytest.raises(ValueError, match="size"):
        camera().rays(size)


def test_a_camera_under_water_is_refused_and_one_just_above_is_not():
    spectrum = jo.spectra.Elfouhaily(jo.Wind(speed=12.0))
    sea = jo.surface.realise(spectrum, jo.surface.Cascade((100.0,), 32), key=jax.random.key(0))
    place = np.array([12.0, 7.0])
    water = float(sea.height_at(place, 2.0, 1.2))
    fields = sea.fields(2.0, 1.2)
    for known in (None, fields):
        check_above(Camera((*place, water + 1e-3)), sea, 2.0, 1.2, known)
        with pytest.raises(ValueError, match="above the water"):
            check_above(Camera((*place, water - 1e-3)), sea, 2.0, 1.2, known)


def test_no_water_is_higher_than_its_bound_and_the_bound_knows_where_crests_are():
    cascade = jo.surface.Cascade((100.0, 13.0), 32)
    sea = jo.surface.realise(jo.spectra.Elfouhaily(jo.Wind(speed=9.0)), cascade, key=jax.random.key(1))
    fields = sea.fields(2.0, 1.2)
    places = np.random.default_rng(0).uniform(-300.0, 300.0, (200, 2))
    water = np.asarray(sea.height_at(places, 2.0, 1.2))
    bounds = np.array(
        [highest_over(fields, cascade, reduce_points(p, cascade, np.dtype(float))) for p in places]
    )
    assert np.all(bounds > water)
    highest = float(jnp.sum(jnp.max(fields.height, axis=(-2, -1))))
    assert bounds.min() < 0.5 * highest
