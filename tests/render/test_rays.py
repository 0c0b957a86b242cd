"""What rays see, against planes, brute force, the rasteriser, finite differences and mitsuba."""

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from _brute_force import nearest_triangle, triangles_of_grid
from _views import CAMERAS, TIME, calm_fields, place_on_plane, windy

from jaxocean.io import write_mesh
from jaxocean.render import EARTH_CURVATURE, Camera, Raster, Rays, map_visible, patch_mesh, visible_points
from jaxocean.render._mesh import displacement_atlas
from jaxocean.render._ray_march import first_crossing
from jaxocean.render._ray_root import meet_surface
from jaxocean.render._rays import RayScene
from jaxocean.render._steepness import Steepness
from jaxocean.surface import Cascade

SIZE = (24, 32)
CASCADE = Cascade((100.0, 23.0), 32)


@eqx.filter_jit
def see_and_vary(fields, camera, curvature, fields_change, camera_change):
    """Depth and place of what rays see, their derivatives along a change of fields and camera, and all the rest."""

    def find(fields, camera):
        visible, _ = visible_points(fields, CASCADE, camera, SIZE, method=Rays(), curvature=curvature)
        return (visible.depth, *visible.place), visible

    return jax.jvp(find, (fields, camera), (fields_change, camera_change), has_aux=True)


def see(fields, camera, curvature=0.0):
    still = jax.tree.map(jnp.zeros_like, (fields, camera))
    _, changes, visible = see_and_vary(fields, camera, jnp.asarray(curvature), *still)
    for leaf in jax.tree.leaves((changes, visible)):
        assert np.all(np.isfinite(leaf))
    return visible


@eqx.filter_jit
def displaced_places(fields, camera, curvature, place):
    scene = RayScene.of_fields(fields, CASCADE, camera, SIZE, Rays(), curvature)
    return jnp.stack(scene.surface(*place), axis=-1) + camera.position * jnp.array([1.0, 1.0, 0.0])


@eqx.filter_jit
def find_water(fields, camera, curvature):
    return map_visible(
        lambda v: (v.hit, v.depth), fields, CASCADE, camera, SIZE, method=Rays(), curvature=curvature
    )[0]


@pytest.fixture(scope="module")
def sea():
    return windy(CASCADE, 12.0)


@pytest.fixture(scope="module")
def rough(sea):
    return sea.fields(TIME, 1.2)


@pytest.mark.parametrize("name", CAMERAS)
def test_a_calm_sea_is_the_plane_with_its_footprints(name):
    camera = CAMERAS[name]
    visible = see(calm_fields(CASCADE), camera)
    rays = np.asarray(camera.rays(SIZE))
    below = rays[..., 2] < -1e-4
    np.testing.assert_array_equal(visible.hit, below)
    exact = (float(camera.position[2]) / -rays[..., 2])[below]
    np.testing.assert_allclose(visible.depth[below], exact, rtol=1e-9)

    pixels = np.argwhere(below)
    expected = jax.vmap(jax.jacfwd(lambda pixel: place_on_plane(camera, SIZE, pixel)))(
        jnp.asarray(pixels[:, ::-1] + 0.5)
    )
    found = np.asarray(visible.footprint.axes)[tuple(pixels.T)]
    # What keeps footprints bounded where they are seen edge on takes a part in 2500 from all of them.
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_no_pixel_of_a_calm_sea_is_void_from_any_height(dtype):
    fields = jax.tree.map(lambda x: x.astype(np.result_type(dtype, np.complex64)), calm_fields(CASCADE))
    views = [(camera, curvature) for camera in CAMERAS.values() for curvature in (0.0, EARTH_CURVATURE)]
    for height in (2e6, 6e6, 2e7):
        for pitch in (1.2, np.pi / 2):
            camera = Camera((0.0, 0.0, height), heading=0.4, pitch=pitch, roll=0.3, field_of_view=1.0)
            views.append((camera, EARTH_CURVATURE))
    seen = 0
    for camera, curvature in views:
        hit, depth = map(np.asarray, find_water(fields, camera.astype(dtype), jnp.asarray(curvature, dtype)))
        height = float(camera.position[2])
        # The ray meets the sphere if it points further down than the limb is; here it does so first.
        sine = -np.asarray(camera.rays(SIZE))[..., 2]
        down, limb = np.arcsin(sine), np.arccos(1 / (1 + curvature * height))
        margin = 1e-3 / float(camera.focal_length(SIZE))
        inside = down > limb + margin
        assert np.all(hit[inside]), (height, curvature)
        assert not np.any(hit[down < limb - margin]), (height, curvature)
        slant, rest = (1 + curvature * height) * sine[inside], height * (2 + curvature * height)
        exact = rest / (slant + np.sqrt(slant**2 - curvature * rest))
        np.testing.assert_allclose(depth[inside], exact, rtol=1e-4 if dtype == np.float32 else 1e-8)
        seen += inside.sum()
    assert seen > 7000


def test_rays_end_where_a_fine_mesh_of_the_same_surface_is(rough):
    camera = Camera((5.0, 3.0, 7.0), heading=0.3, pitch=0.6, field_of_view=0.35)
    visible = see(rough, camera)
    assert np.all(visible.hit)
    centre = np.asarray(jnp.mean(visible.rest_point, axis=(0, 1)))
    vertices, _ = patch_mesh(rough, CASCADE, centre=tuple(centre), side=34.0, quads=256)
    triangles = triangles_of_grid(vertices.reshape(257, 257, 3))
    pixels = np.s_[::3, ::4]
    rays = np.asarray(camera.rays(SIZE)[pixels]).reshape(-1, 3)
    expected = nearest_triangle(triangles, np.asarray(camera.position), rays)
    error = np.abs(np.asarray(visible.depth[pixels]).ravel() - expected)
    assert np.std(expected) > 1
    # Chords of cells 13 cm wide, under a view at 20 to 40 degrees.
    assert np.median(error) < 2e-3
    assert np.quantile(error, 0.95) < 2e-2


@pytest.mark.parametrize("curvature", [0.0, EARTH_CURVATURE])
def test_the_displaced_rest_point_lies_on_the_ray(rough, curvature):
    camera = CAMERAS["rolled"]
    visible = see(rough, camera, curvature)
    met = displaced_places(rough, camera, jnp.asarray(curvature), visible.place)
    # The last kilometres are at the horizon.
    near = np.asarray(visible.hit & (visible.depth < 2e3))
    assert near.sum() > 300
    assert np.max(np.linalg.norm(met - visible.position, axis=-1)[near]) < 1e-3


def test_no_crest_is_passed_that_shorter_steps_would_meet(rough):
    camera = Camera((5.0, 3.0, 4.0), heading=0.3, pitch=0.15, field_of_view=0.5)

    @jax.jit
    def march(fields, least_step, steeper):
        scene = RayScene.of_fields(fields, CASCADE, camera, SIZE, Rays(), jnp.asarray(0.0))
        steepness = Steepness(scene.steepness.first, scene.steepness.table * steeper)
        rays, height = camera.rays(SIZE), camera.position[2]
        return first_crossing(scene.surface, steepness, scene.bounds, rays, height, least_step)

    usual, careful = (
        march(rough, jnp.asarray(step), jnp.asarray(by)) for step, by in ((0.5, 1.0), (0.02, 3.0))
    )
    assert np.mean(careful.steps) > 2 * np.mean(usual.steps)
    assert np.mean(careful.hit) > 0.5
    other = np.abs(np.asarray(usual.depth) - np.asarray(careful.depth)) > 0.01 * np.asarray(careful.depth)
    assert np.mean(np.where(careful.hit & usual.hit, other, careful.hit != usual.hit)) < 0.01


def test_rays_and_rasters_find_water_in_the_same_pixels(rough):
    raster = eqx.filter_jit(
        lambda fields, camera, curvature: map_visible(
            lambda v: v.hit, fields, CASCADE, camera, SIZE, method=Raster(2.0), curvature=curvature
        )[0]
    )
    edges = 0
    for height, pitch, curvature in ((4.0, 0.05, 0.0), (30.0, 0.2, 0.0), (30.0, 0.2, EARTH_CURVATURE)):
        camera = Camera((40.0, 30.0, height), heading=1.0, pitch=pitch, roll=0.1, field_of_view=0.6)
        hit = np.asarray(see(rough, camera, curvature).hit)
        other = np.asarray(raster(rough, camera, jnp.asarray(curvature)))
        wide = np.pad(other, 1, mode="edge")
        around = np.stack([wide[i : i + 24, j : j + 32] for i in range(3) for j in range(3)])
        inside, outside = around.all(0), ~around.any(0)
        assert np.all(hit[inside])
        assert not np.any(hit[outside])
        assert inside.any()
        assert outside.any()
        edges += np.sum(~inside & ~outside)
    assert edges > 0


def test_crests_above_a_low_camera_are_seen_against_the_sky(sea):
    fields = sea.fields(TIME, 1.2)
    water = float(sea.height_at(np.array([10.0, 20.0]), TIME, 1.2))
    crests = 0
    for heading in (0.0, 2.0, 4.0):
        camera = Camera((10.0, 20.0, water + 0.4), heading=heading, pitch=0.0, field_of_view=1.0)
        visible = see(fields, camera)
        rays = np.asarray(camera.rays(SIZE))
        assert np.all(np.asarray(visible.hit)[rays[..., 2] < -1e-4])
        above = np.asarray(visible.hit) & (rays[..., 2] > 0)
        assert np.all(np.asarray(visible.position)[above][:, 2] > float(camera.position[2]))
        crests += above.sum()
    assert crests > 20


@pytest.mark.parametrize("what", ["height", "choppiness", "time"])
def test_the_derivative_of_depth_is_that_of_central_differences(sea, what):
    def scene(x):
        camera = Camera(
            jnp.stack([jnp.asarray(1.0), jnp.asarray(2.0), x["height"]]), pitch=0.7, field_of_view=0.7
        )
        return sea.fields(x["time"], x["choppiness"]), camera

    x = {"height": jnp.asarray(25.0), "choppiness": jnp.asarray(0.8), "time": jnp.asarray(1.5)}
    along = {name: jnp.asarray(float(name == what)) for name in x}
    scene, zero = jax.jit(scene), jnp.asarray(0.0)
    still = jax.tree.map(jnp.zeros_like, scene(x))

    def depth(step):
        at = jax.tree.map(lambda value, change: value + step * change, x, along)
        return np.asarray(see_and_vary(*scene(at), zero, *still)[0][0])

    expected = (depth(1e-5) - depth(-1e-5)) / 2e-5
    (fields, camera), (fields_change, camera_change) = jax.jvp(scene, (x,), (along,))
    found = np.asarray(see_and_vary(fields, camera, zero, fields_change, camera_change)[1][0])
    assert np.std(expected) > 0
    error = np.linalg.norm(found - expected) / np.linalg.norm(expected)
    assert error < 0.01


@pytest.mark.slow
def test_the_derivative_is_the_same_in_reverse(sea):
    camera = Camera((1.0, 2.0, 25.0), pitch=0.7, field_of_view=0.7)
    fields = sea.fields(TIME, 0.8)
    visible = see(fields, camera)

    def mean_depth(fields, height):
        scene = RayScene.of_fields(fields, CASCADE, camera, SIZE, Rays(), jnp.asarray(0.0))
        start = *visible.place, visible.depth
        slant = scene.surface.view(*visible.place)[1]
        rays = camera.rays(SIZE)
        return jnp.mean(meet_surface(scene.surface, start, visible.hit, rays, height, slant)[2])

    height = jnp.asarray(25.0)
    change = jax.tree.map(lambda x: 1e-3 * x, fields)
    backwards = jax.jit(jax.grad(mean_depth, argnums=(0, 1)))(fields, height)
    forwards = jax.jit(lambda f, h: jax.jvp(mean_depth, (fields, height), (f, h))[1])(
        change, jnp.asarray(0.1)
    )
    # JAX's gradient of a real number by a complex one is the conjugate of the pair of derivatives.
    pairs = zip(jax.tree.leaves(backwards[0]), jax.tree.leaves(change), strict=True)
    total = sum(float(jnp.sum((g * c).real)) for g, c in pairs) + 0.1 * float(backwards[1])
    np.testing.assert_allclose(total, float(forwards), rtol=1e-6)


def test_the_horizon_of_a_round_planet_is_as_low_as_its_height_tells():
    height = 2e5
    dip = np.arccos(1 / (1 + height * EARTH_CURVATURE))
    camera = Camera((0.0, 0.0, height), pitch=dip, field_of_view=0.1)
    visible = see(calm_fields(CASCADE), camera, EARTH_CURVATURE)
    rows = np.asarray(visible.hit)[:, 16]
    assert not rows[:11].any()
    assert rows[13:].all()
    place = np.asarray(visible.position)[np.asarray(visible.hit)]
    radius = np.hypot(np.hypot(place[:, 0], place[:, 1]), place[:, 2] + 1 / EARTH_CURVATURE)
    np.testing.assert_allclose(radius * EARTH_CURVATURE, 1, atol=1e-9)


def test_several_rays_a_pixel_find_the_share_of_it_that_is_water():
    camera = Camera((0.0, 0.0, 20.0), pitch=0.12, roll=0.2, field_of_view=0.8)
    water = eqx.filter_jit(
        lambda fields: map_visible(
            lambda v: (v.hit.astype(float), v.hit), fields, CASCADE, camera, SIZE, method=Rays(samples=4)
        )[0]
    )
    share, most = water(calm_fields(CASCADE))
    focal = 12 / np.tan(0.4)
    level = focal * np.tan(0.12) / np.cos(0.2)
    assert share.shape == SIZE
    np.testing.assert_allclose(np.mean(share), (12 + level) / 24, atol=0.5 / 96)
    assert np.sum((share > 0) & (share < 1)) > 20
    np.testing.assert_array_equal(most, share >= 0.5)


def test_parts_of_a_pixel_are_as_long_and_as_wide_as_there_are_rays_down_and_across():
    camera = Camera((0.0, 0.0, 20.0), pitch=0.5, field_of_view=0.3)

    def edges(samples):
        of = eqx.filter_jit(
            lambda fields: map_visible(
                lambda v: v.edges_of_footprint, fields, CASCADE, camera, SIZE, method=Rays(samples)
            )[0]
        )
        return [np.asarray(each) for each in of(calm_fields(CASCADE))]

    (_, x_row, y_column, _), found = edges(1), edges((4, 2))
    # Rows run away from the camera, along x, and columns across.
    np.testing.assert_allclose(found[1], x_row / 4, rtol=0.01)
    np.testing.assert_allclose(found[2], y_column / 2, rtol=0.01)


def test_more_rays_down_than_across_say_more_of_distant_water_than_a_square_of_them(sea):
    camera = Camera((1.0, 2.0, 5.0), pitch=0.1, field_of_view=0.15)
    fields = sea.fields(TIME, 0.8)

    def slopes(samples):
        of = eqx.filter_jit(
            lambda fields: map_visible(
                lambda v: v.slope[..., 0], fields, CASCADE, camera, SIZE, method=Rays(samples)
            )[0]
        )
        return np.asarray(of(fields))

    exact = slopes(6)
    off = {samples: np.std(slopes(samples) - exact) for samples in (2, (4, 1))}
    assert off[(4, 1)] < 0.8 * off[2]


@pytest.mark.slow
def test_rays_of_several_cameras_are_batched_by_vmap():
    def depth(height):
        camera = Camera(jnp.stack([0 * height, 0 * height, height]), pitch=0.5)
        return map_visible(lambda v: v.depth, calm_fields(CASCADE), CASCADE, camera, SIZE, method=Rays())[0]

    found = eqx.filter_jit(eqx.filter_vmap(depth))(jnp.array([10.0, 30.0]))
    np.testing.assert_allclose(found[1][12:], 3 * found[0][12:], rtol=1e-9)


def test_the_steepest_gradient_is_that_of_the_steepest_cell(sea):
    alone = Cascade((23.0,), 32)
    fields = windy(alone, 12.0, seed=1).fields(TIME, 1.0)
    x, y = jnp.asarray(np.random.default_rng(0).uniform(0, 23, (2, 20000)))

    @jax.jit
    def steepest_and_bound(fields, variance):
        atlas = displacement_atlas(fields, alone)
        gradient = [
            jax.jvp(lambda x, y: atlas(jnp.zeros(2), x, y, variance + 0 * x)[2], (x, y), tangent)[1]
            for tangent in ((0 * x + 1, 0 * x), (0 * x, 0 * x + 1))
        ]
        return jnp.max(jnp.hypot(*gradient)), Steepness.of_atlas(atlas)(variance)[1]

    for variance in (0.01, 0.3, 3.0):
        steepest, bound = steepest_and_bound(fields, jnp.asarray(variance))
        assert steepest <= bound
        assert bound < 1.6 * steepest


def test_a_patch_is_the_sea_at_its_samples_and_faces_up(sea):
    alone = Cascade((23.0,), 32)
    one = windy(alone, 12.0, seed=1)
    vertices, faces = patch_mesh(one.fields(TIME, 0.7), alone, centre=(11.5, 11.5), side=23.0, quads=32)
    rest = np.stack(np.meshgrid(np.linspace(0, 23, 33), np.linspace(0, 23, 33)), -1).reshape(-1, 2)
    at = jnp.asarray(rest)
    expected = np.column_stack([rest + one.displacement(at, TIME, 0.7), one.height(at, TIME)])
    np.testing.assert_allclose(vertices, expected, atol=1e-9)
    corners = np.asarray(vertices)[np.asarray(faces)]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(normal[:, 2] > 0)
    np.testing.assert_allclose(0.5 * normal[:, 2].sum(), 23.0**2, rtol=1e-9)


@pytest.mark.parametrize(("method", "middle", "most"), [(Rays(), 1e-3, 2e-2), (Raster(2.0), 1e-2, 0.1)])
def test_depth_and_normal_are_those_of_mitsuba_on_the_exported_mesh(rough, tmp_path, method, middle, most):
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    camera = Camera((5.0, 3.0, 7.0), heading=0.3, pitch=0.6, field_of_view=0.35)
    visible, _ = visible_points(rough, CASCADE, camera, SIZE, method=method)
    centre = np.asarray(jnp.mean(visible.rest_point, axis=(0, 1)))
    patch = patch_mesh(rough, CASCADE, centre=tuple(centre), side=34.0, quads=512)
    file = write_mesh(tmp_path / "patch.ply", *patch)
    scene = mitsuba.load_dict(
        {"type": "scene", "sea": {"type": "ply", "filename": str(file), "face_normals": True}}
    )
    depth, normal = np.zeros(SIZE), np.zeros((*SIZE, 3))
    rays = np.asarray(camera.rays(SIZE))
    for pixel in np.ndindex(SIZE):
        ray = mitsuba.Ray3f(o=list(map(float, camera.position)), d=list(map(float, rays[pixel])))
        met = scene.ray_intersect(ray)
        depth[pixel], normal[pixel] = met.t, np.asarray(met.n).ravel()
    error = np.abs(np.asarray(visible.depth) - depth)
    assert np.median(error) < middle
    assert np.quantile(error, 0.99) < most
    turn = np.degrees(np.arccos(np.clip(np.sum(normal * np.asarray(visible.normal), -1), -1, 1)))
    # The mesh is bilinear between samples 72 cm apart, what the pixels see is smoother.
    assert np.median(turn) < 2
    assert np.quantile(turn, 0.99) < 8


def test_choices_that_make_no_sense_are_refused(rough):
    with pytest.raises(ValueError, match="samples"):
        Rays(samples=0)
    for samples in ((2, 0), (65, 1)):
        with pytest.raises(ValueError, match="samples"):
            Rays(samples=samples)
    with pytest.raises(ValueError, match="least_step"):
        Rays(least_step=0.0)
    with pytest.raises(ValueError, match="samples"):
        visible_points(rough, CASCADE, CAMERAS["low"], SIZE, method=Rays(samples=2))
    with pytest.raises(ValueError, match="quads"):
        patch_mesh(rough, CASCADE, quads=0)
    with pytest.raises(ValueError, match="side"):
        patch_mesh(rough, CASCADE, side=-1.0)
