"""What the rasteriser sees, against planes, against brute force, and against finite differences."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _brute_force import nearest_triangle, triangles_of_grid
from _derivatives import finite_difference
from _views import CAMERAS, TIME, calm_fields, place_on_plane, windy

from jaxocean.filtering import Footprint, MomentPyramid
from jaxocean.render import EARTH_CURVATURE, Camera, Raster, SurfaceMoments, map_visible, visible_points
from jaxocean.render._bounds import Bounds
from jaxocean.render._map_visible import map_image
from jaxocean.render._mesh import displaced_mesh, displacement_atlas
from jaxocean.render._projected_grid import rest_grid
from jaxocean.surface import Cascade

SIZE = (48, 80)
CASCADE = Cascade((200.0, 23.0), 32)


def in_float32(tree):
    return jax.tree.map(lambda x: x.astype(np.complex64 if jnp.iscomplexobj(x) else np.float32), tree)


@pytest.fixture(scope="module")
def sea():
    return windy(CASCADE, 14.0)


@pytest.fixture(scope="module")
def storm():
    return windy(CASCADE, 28.0, seed=4)


@pytest.mark.parametrize("name", CAMERAS)
def test_a_flat_sea_is_the_plane(name):
    camera = CAMERAS[name]
    visible, _ = visible_points(calm_fields(CASCADE), CASCADE, camera, SIZE)
    rays = np.asarray(camera.rays(SIZE))
    below = rays[..., 2] < -1e-4
    assert below.any()
    np.testing.assert_array_equal(visible.hit, below)
    exact = (float(camera.position[2]) / -rays[..., 2])[below]
    np.testing.assert_allclose(visible.depth[below], exact, rtol=1e-6)
    place = np.asarray(camera.position[:2]) + exact[:, None] * rays[below][:, :2]
    np.testing.assert_allclose(visible.rest_point[below], place, rtol=1e-6, atol=1e-6 * np.abs(place).max())
    np.testing.assert_allclose(visible.position[below][:, 2], 0, atol=1e-6 * exact.max())
    assert np.all(np.asarray(visible.normal)[below] == [0, 0, 1])


def test_footprints_of_a_flat_sea_are_the_derivatives_of_its_plane():
    camera = CAMERAS["rolled"]
    visible, _ = visible_points(calm_fields(CASCADE), CASCADE, camera, SIZE)

    pixels = np.argwhere(np.asarray(visible.hit))[::97]
    expected = jax.vmap(jax.jacfwd(lambda pixel: place_on_plane(camera, SIZE, pixel)))(
        jnp.asarray(pixels[:, ::-1] + 0.5)
    )
    found = np.asarray(visible.footprint.axes)[tuple(pixels.T)]
    np.testing.assert_allclose(found, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())


@pytest.mark.slow
def test_no_pixel_below_the_horizon_is_void_for_a_hundred_cameras(storm):
    rng = np.random.default_rng(0)
    see = eqx.filter_jit(
        lambda fields, camera, curvature: map_visible(
            lambda v: (v.hit, v.depth, v.seen), fields, CASCADE, camera, SIZE, curvature=curvature
        )
    )
    crests = 0
    places = rng.uniform(-2e3, 2e3, (100, 2))
    water = np.asarray(storm.height_at(places[1::2], TIME, 1.3))
    among, wilder = (in_float32(storm.fields(TIME, choppiness)) for choppiness in (1.3, 2.5))
    for number, place in enumerate(places):
        # Cameras among the waves, where margins matter most and crests are above the camera, and up to high orbit.
        fields = among if number % 2 else wilder
        height = water[number // 2] + rng.uniform(0.2, 3.0) if number % 2 else 10 ** rng.uniform(1.3, 7.6)
        camera = Camera(
            (*place, height),
            heading=rng.uniform(-3, 3),
            pitch=rng.uniform(-0.4, np.pi / 2),
            field_of_view=rng.uniform(0.2, 2.0),
            roll=rng.uniform(-3, 3) if number % 3 else 0.0,
        )
        curvature = EARTH_CURVATURE if number % 4 == 0 else 0.0
        (hit, *numbers), edges = see(fields, camera, np.float32(curvature))
        down = np.arcsin(-np.asarray(camera.rays(SIZE))[..., 2])
        horizon = np.arccos(1 / (1 + curvature * height))
        pixel = float(camera.field_of_view) / SIZE[0]
        below = down > horizon + (0.5 * pixel if curvature else 1e-4)
        void = np.sum(below & ~np.asarray(hit))
        assert void == 0, (
            f"{void} void pixels of camera {number}: {eqx.tree_pformat(camera, short_arrays=False)}"
        )
        crests += int(np.sum(np.asarray(hit) & (down < -1e-3)))
        for leaf in jax.tree.leaves((numbers, edges)):
            assert np.all(np.isfinite(leaf))
    assert crests > 100, "some crests must rise above the horizon for this test to mean all it says"


@pytest.mark.parametrize("height", [9.0, 45.0])
def test_depths_are_those_of_brute_force_on_the_same_mesh(storm, height):
    fields = storm.fields(TIME, 1.8)
    camera = Camera((5.0, 3.0, height), heading=0.3, pitch=0.35, field_of_view=1.2)
    size = SIZE
    zero = jnp.zeros(())
    grid = rest_grid(camera, size, 4.0, Bounds.of_fields(fields), zero)
    mesh = displaced_mesh(grid, displacement_atlas(fields, CASCADE), camera, size, zero)
    rays = np.asarray(camera.rays(size)).reshape(-1, 3)
    start = np.array([0.0, 0.0, height])
    expected = nearest_triangle(triangles_of_grid(mesh.place), start, rays).reshape(size)
    visible, _ = visible_points(fields, CASCADE, camera, size)
    np.testing.assert_array_equal(visible.hit, np.isfinite(expected))
    hit = np.asarray(visible.hit)
    ratio = np.asarray(visible.depth)[hit] / expected[hit]
    # Sheets closer than the steps of the depth buffer may be taken for each other.
    np.testing.assert_allclose(ratio, 1, atol=2e-3)
    assert np.mean(np.abs(ratio - 1) < 1e-6) > 0.99


def test_a_finer_mesh_sees_the_surface_itself(sea):
    fields = sea.fields(TIME, 1.0)
    camera = Camera((0.0, 0.0, 25.0), pitch=1.2, field_of_view=0.9)
    visible, _ = visible_points(fields, CASCADE, camera, SIZE, method=Raster(1.0))
    point = jnp.asarray(visible.rest_point)
    exact = jnp.concatenate(
        [point + sea.displacement(point, TIME, 1.0), sea.height(point, TIME)[..., None]], axis=-1
    )
    error = np.linalg.norm(np.asarray(visible.position - exact), axis=-1)
    assert np.sqrt(np.mean(error**2)) < 0.12 * float(jnp.std(jnp.sum(fields.height, 0)))


def smooth_number_and_water_share(x, sea):
    """Two numbers from the whole image: one of everything smooth that pixels see, and the share of it that is water.

    Of the camera's place, pitch, roll and field of view, and the sea's choppiness and time.
    """
    camera = Camera(x[:3], pitch=x[3], roll=x[4], field_of_view=x[5])
    (image, hit), edges = map_visible(
        lambda v: (
            v.seen.slope[0] + 10 * v.seen.slopes[1] + v.seen.strain[1] + 1 / v.depth,
            v.hit.astype(float),
        ),
        sea.fields(x[7], x[6]),
        CASCADE,
        camera,
        SIZE,
    )
    return jnp.stack([jnp.mean(edges.blend(image) ** 2), jnp.mean(edges.blend(hit))])


HEIGHT, PITCH, ROLL, CHOPPINESS, AT = jnp.eye(8)[jnp.array([2, 3, 4, 6, 7])]


@pytest.fixture(scope="module")
def differentiate():
    """Both numbers and their derivatives along a direction: one program for all tests, one direction at a time."""
    return jax.jit(
        lambda x, sea, along: jax.jvp(lambda y: smooth_number_and_water_share(y, sea), (x,), (along,))
    )


@pytest.mark.slow
def test_the_derivative_of_a_smooth_image_is_that_of_finite_differences(differentiate, sea):
    x = jnp.array([1.0, 2.0, 45.0, 0.9, 0.2, 0.8, 0.8, 1.5])
    steps = ((HEIGHT, 1e-4), (PITCH, 1e-6), (ROLL, 1e-6), (CHOPPINESS, 1e-5), (AT, 1e-5))
    for along, step in steps:
        expected = finite_difference(lambda y: differentiate(y, sea, HEIGHT)[0][0], x, along, step)
        found = differentiate(x, sea, along)[1][0]
        np.testing.assert_allclose(found, expected, rtol=0.01, err_msg=f"along {along}")


@pytest.mark.slow
def test_the_horizon_covers_the_area_below_it_and_has_its_derivative(differentiate, sea):
    calm = eqx.tree_at(lambda s: (s.waves.cosine, s.waves.sine), sea, replace_fn=jnp.zeros_like)
    x = jnp.array([0.0, 0.0, 20.0, 0.12, 0.2, 0.8, 1.0, TIME])
    focal = 24 / np.tan(0.4)
    level = focal * np.tan(0.12) / np.cos(0.2)  # pixels above the centre
    found = [differentiate(x, calm, along) for along in (PITCH, ROLL)]
    np.testing.assert_allclose(found[0][0][1], (24 + level) / 48, atol=2e-4)
    expected = [
        focal / np.cos(0.12) ** 2 / np.cos(0.2) / 48,
        level * np.tan(0.2) / 48,
    ]
    np.testing.assert_allclose([slope[1] for _, slope in found], expected, rtol=0.02, atol=0.005)


@pytest.mark.slow
def test_crest_edges_carry_the_derivative_of_the_area_that_water_covers(differentiate, storm):
    x = jnp.array([30.0, 60.0, 9.0, 0.05, 0.0, 0.5, 1.2, TIME])
    for along, step in ((HEIGHT, 0.02), (PITCH, 1e-3)):
        expected = finite_difference(lambda y: differentiate(y, storm, HEIGHT)[0][1], x, along, step)
        np.testing.assert_allclose(differentiate(x, storm, along)[1][1], expected, rtol=0.05)


def test_silhouettes_that_are_held_change_no_picture_and_carry_no_derivative(storm):
    fields = storm.fields(TIME, 1.2)

    def share(pitch, moving):
        camera = Camera((0.0, 0.0, 9.0), pitch=pitch, field_of_view=0.5)
        water, edges = map_image(
            lambda visible: jnp.ones_like(visible.depth),
            lambda pixels: jnp.zeros(pixels.hit.shape),
            fields,
            CASCADE,
            camera,
            (24, 32),
            method=Raster(moving_silhouettes=moving),
        )
        return jnp.mean(edges.blend(water))

    value, change = jax.jit(jax.value_and_grad(lambda p: share(p, True)))(0.05)
    same, none = jax.jit(jax.value_and_grad(lambda p: share(p, False)))(0.05)
    assert abs(change) > 1e-4
    np.testing.assert_allclose(same, value, rtol=1e-12)
    assert none == 0


def test_what_a_wider_filter_takes_from_the_means_it_gives_to_the_covariances(sea):
    fields = sea.fields(TIME, 1.3)
    moments = SurfaceMoments.from_fields(fields, CASCADE)
    x, y = jnp.asarray(np.random.default_rng(0).uniform(0, 4600, (2, 60000)))
    variance = jnp.sum(fields.slope**2, axis=(0, -1)).mean(), jnp.sum(fields.strain**2, axis=(0, -1)).mean()
    look_up = eqx.filter_jit(lambda moments, variance: moments(jnp.zeros(2), x, y, variance))
    shares = []
    for width in (0.02, 2.0, 13.0, 40.0, 200.0, 3000.0):
        seen = look_up(moments, jnp.full(x.shape, width**2 / 12))
        slope = np.mean(sum(s**2 for s in seen.slope)), np.mean(sum(seen.slopes[:2]))
        strain = np.mean(sum(s**2 for s in seen.strain)), np.mean(sum(seen.strains[:3]))
        np.testing.assert_allclose(sum(slope), variance[0], rtol=0.03)
        np.testing.assert_allclose(sum(strain), variance[1], rtol=0.03)
        shares.append(slope[0] / variance[0])
    assert shares[2] > 0.2
    assert shares[-1] < 1e-4
    assert np.all(np.diff(shares[1:]) < 0)


def test_moments_agree_on_average_with_those_of_the_exact_pyramid(sea):
    fields = sea.fields(TIME, 1.3)
    fast, exact = SurfaceMoments.from_fields(fields, CASCADE), MomentPyramid.from_fields(fields, CASCADE)
    x, y = jnp.asarray(np.random.default_rng(1).uniform(0, 4600, (2, 4000)))
    for side in (10.0, 20.0):
        seen = fast(jnp.zeros(2), x, y, jnp.full(x.shape, side**2 / 12))
        found = exact(Footprint.square(jnp.stack([x, y], -1), side), probes=1)
        assert np.corrcoef(seen.slope[0], found.slope_mean[:, 0])[0, 1] > 0.99
        total = np.mean(found.slope_mean[:, 0] ** 2 + found.slope_covariance[:, 0, 0])
        assert abs(np.mean(seen.slopes[0]) - np.mean(found.slope_covariance[:, 0, 0])) < 0.1 * total
        total = np.mean(found.strain_mean[:, 1] ** 2 + found.strain_covariance[:, 1, 1])
        assert abs(np.mean(seen.strains[1]) - np.mean(found.strain_covariance[:, 1, 1])) < 0.1 * total


def test_a_camera_one_period_away_sees_the_same(sea):
    fields = sea.fields(TIME, 1.3)
    near = visible_points(fields, CASCADE, CAMERAS["oblique"], SIZE)[0]
    moved = eqx.tree_at(
        lambda c: c.position,
        CAMERAS["oblique"],
        CAMERAS["oblique"].position + jnp.array([4600.0, -9200.0, 0]),
    )
    far = visible_points(fields, CASCADE, moved, SIZE)[0]
    np.testing.assert_allclose(near.depth, far.depth, rtol=1e-9)
    np.testing.assert_allclose(near.slope, far.slope, atol=1e-9)


def test_the_horizon_of_a_round_planet_is_as_low_as_its_height_tells():
    height, curvature = 2e5, EARTH_CURVATURE
    dip = np.arccos(1 / (1 + height * curvature))
    camera = Camera((0.0, 0.0, height), pitch=dip, field_of_view=0.1)
    visible, _ = visible_points(calm_fields(CASCADE), CASCADE, camera, SIZE, curvature=curvature)
    rows = np.asarray(visible.hit)[:, 40]
    assert not rows[:23].any()
    assert rows[25:].all()
    # All of it lies on the sphere.
    place = np.asarray(visible.position)[np.asarray(visible.hit)]
    radius = np.hypot(np.hypot(place[:, 0], place[:, 1]), place[:, 2] + 1 / curvature)
    np.testing.assert_allclose(radius * curvature, 1, atol=2e-4)


@pytest.mark.parametrize("pitch", [0.9, 1.2, np.pi / 2])
def test_the_sea_fills_the_disc_of_the_planet_from_any_orbit(pitch):
    see = eqx.filter_jit(
        lambda camera: visible_points(calm_fields(CASCADE), CASCADE, camera, SIZE, curvature=EARTH_CURVATURE)[
            0
        ]
    )
    seen = 0
    for height in (4e5, 1e6, 2e6, 4e6, 6e6, 1e7, 2e7, 4e7):
        camera = Camera((0.0, 0.0, height), heading=0.7, pitch=pitch)
        visible = see(camera)
        down = np.arcsin(-np.asarray(camera.rays(SIZE))[..., 2])
        limb, pixel = np.arccos(1 / (1 + EARTH_CURVATURE * height)), float(camera.field_of_view) / SIZE[0]
        hit, inside = np.asarray(visible.hit), down > limb + 0.5 * pixel
        assert np.all(hit[inside]), height
        assert not np.any(hit[down < limb - 0.5 * pixel]), height
        seen += hit.sum()
        # The near crossing of the ray with the sphere; the mesh is its chords.
        slant = (1 + EARTH_CURVATURE * height) * np.sin(down[inside])
        rest = height * (2 + EARTH_CURVATURE * height)
        depth = rest / (slant + np.sqrt(slant**2 - EARTH_CURVATURE * rest))
        np.testing.assert_allclose(visible.depth[inside], depth, rtol=0.03)
    assert seen > 3000


def test_cameras_are_batched_by_vmap():
    heights = jnp.array([10.0, 30.0])
    cameras = eqx.filter_vmap(lambda z: Camera(jnp.stack([0 * z, 0 * z, z]), pitch=0.5))(heights)
    see = eqx.filter_vmap(lambda camera: visible_points(calm_fields(CASCADE), CASCADE, camera, SIZE)[0].depth)
    depth = see(cameras)
    below = np.s_[24:]
    np.testing.assert_allclose(depth[1][below], 3 * depth[0][below], rtol=1e-6)


def test_a_spacing_that_makes_no_sense_is_refused():
    with pytest.raises(ValueError, match="spacing"):
        Raster(0.0)
    with pytest.raises(ValueError, match="size"):
        visible_points(calm_fields(CASCADE), CASCADE, CAMERAS["low"], (0, 10))
