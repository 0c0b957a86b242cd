"""What is swept: values as they are typed, designs, and configs of points."""

import itertools
import json

import numpy as np
import pytest
from _sweep_toys import plan
from scipy.stats import qmc

from experiments.harness._errors import UserError
from experiments.sweeps import Design
from experiments.sweeps._design import BLOCK, Axis, build
from experiments.sweeps._values import Between, Listed, Steps, parse


def numbers(text: str) -> list[float]:
    values = parse("key", text)
    assert isinstance(values, Listed | Steps)
    return values.numbers(np.arange(len(values))).tolist()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("4:24:2", [4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24]),
        ("4:9:2", [4, 6, 8]),
        ("0.1:0.7:0.1", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7]),
        ("-1e-1:1e-1:1e-1", [-0.1, 0.0, 0.1]),
        ("3:1:-1", [3, 2, 1]),
        ("1,2.5,10:12:1", [1, 2.5, 10, 11, 12]),
        ("5:5:1", [5]),
    ],
)
def test_ranges_include_their_end_where_they_hit_it_and_hold_exact_decimals(text, expected):
    assert numbers(text) == expected


def test_values_of_a_range_are_spelled_as_one_would_type_them():
    tenths, whole = parse("key", "0:1:0.1"), parse("key", "32:64:32")
    assert isinstance(tenths, Steps)
    assert isinstance(whole, Steps)
    assert [tenths.spell(i) for i in range(4)] == ["0.0", "0.1", "0.2", "0.3"]
    assert [whole.spell(i) for i in range(2)] == ["32", "64"]


def test_lists_hold_names_lists_and_null_and_keep_commas_inside_of_brackets_and_quotes():
    values = parse("key", "elfouhaily,[1,1,0.5],null,true,'a,b',2")
    assert isinstance(values, Listed)
    assert values.values == ("elfouhaily", [1, 1, 0.5], None, True, "a,b", 2)
    assert not values.numeric


@pytest.mark.parametrize("text", ["10", "elfouhaily", "[1,2,3]", "null", "file.nc", "12:30:aa"])
def test_one_value_is_no_axis(text):
    assert parse("key", text) is None


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "must have a value"),
        ("1,,2", "has an empty place"),
        ("4:2:1", "is empty"),
        ("4:8:0", "step other than 0"),
        ("1,2:3", "cannot be part of a list"),
        ("9:4", "low < high"),
        ("1,[2", "cannot be read"),
        ("0:1:1e-30", "more digits"),
    ],
)
def test_values_that_make_no_sense_are_refused_in_one_sentence(text, says):
    with pytest.raises(UserError, match=says) as error:
        parse("wind.speed", text)
    assert "wind.speed" in str(error.value)
    assert "\n" not in str(error.value)


def axis(key: str, text: str) -> Axis:
    values = parse(key, text)
    assert values is not None
    return Axis(key, values)


def points(design: Design, start: int = 0, stop: int | None = None) -> np.ndarray:
    codes = design.codes(start, design.count if stop is None else stop)
    return np.stack([a.values.numbers(c) for a, c in zip(design.axes, codes, strict=True)], axis=1)


def test_a_cartesian_design_has_every_combination_in_ascending_order_with_the_last_key_fastest():
    design = build("cartesian", [axis("a", "3,1"), axis("b", "30:10:-10")], points=None, seed=0)
    assert design.shape == (2, 3)
    assert points(design).tolist() == [[1, 10], [1, 20], [1, 30], [3, 10], [3, 20], [3, 30]]


def test_a_zipped_design_takes_values_side_by_side_in_the_given_order():
    design = build("zip", [axis("a", "3,1,1"), axis("b", "10:30:10")], points=None, seed=0)
    assert points(design).tolist() == [[3, 10], [1, 20], [1, 30]]


def test_a_sobol_design_is_scipys_scrambled_sequence_between_the_ends():
    design = build("sobol", [axis("a", "0:1"), axis("b", "-2.0:2.0")], points=64, seed=5)
    expected = qmc.scale(qmc.Sobol(2, scramble=True, rng=5).random(64), [0, -2], [1, 2])
    # The ends of `a` are whole, and so are its numbers.
    assert set(points(design)[:, 0].tolist()) == {0.0, 1.0}
    np.testing.assert_allclose(points(design)[:, 1], expected[:, 1], rtol=1e-15)


@pytest.mark.parametrize("kind", ["sobol", "random"])
def test_any_part_of_a_drawn_design_can_be_drawn_alone(kind):
    axes = [axis("a", "0.5:1.5"), axis("b", "1,2,3"), axis("c", "1:4")]
    design = build(kind, axes, points=3 * BLOCK + 10, seed=1)
    whole = points(design)
    cuts = [0, 1, 700, BLOCK, BLOCK + 1, 2 * BLOCK + 5, design.count]
    parts = [points(design, a, b) for a, b in itertools.pairwise(cuts)]
    np.testing.assert_array_equal(np.concatenate(parts), whole)
    assert set(whole[:, 1]) == {1.0, 2.0, 3.0}
    assert set(whole[:, 2]) == {1.0, 2.0, 3.0, 4.0}
    assert 0.5 <= whole[:, 0].min() < 0.51
    assert whole[:, 0].mean() == pytest.approx(1.0, abs=0.02)
    other = points(build(kind, axes, points=100, seed=2))
    assert not np.array_equal(other, whole[:100])


@pytest.mark.parametrize(
    ("kind", "axes", "count", "says"),
    [
        ("cartesian", [], None, "Nothing is swept"),
        ("sobol", [], 8, "Nothing is swept"),
        ("cartesian", [axis("a", "1,2,1.0")], None, "`a` must differ, but 1.0 is there twice"),
        ("cartesian", [axis("a", "x,y,x")], None, '"x" is there twice'),
        ("zip", [axis("a", "1,2,1"), axis("b", "3,4,3")], None, "a=1, b=3 is there twice"),
        ("zip", [axis("a", "1,2,3"), axis("b", "3,4")], None, "`a` has 3, `b` has 2"),
        ("cartesian", [axis("a", "1:2")], None, "start:stop:step"),
        ("random", [axis("a", "1:2")], None, "none is given"),
        ("random", [axis("a", "1:2")], 0, "it is 0"),
        ("random", [axis("a", "1,2")], 9, "at least one interval"),
        ("cartesian", [axis("a", "1,2")], 9, "--points"),
        ("cartesian", [axis("a", "1:100000:1"), axis("b", "1:100000:1")], None, "more than a billion"),
    ],
)
def test_designs_without_points_or_with_points_twice_are_refused(kind, axes, count, says):
    with pytest.raises(UserError, match=says.replace("(", r"\(")):
        build(kind, axes, points=count, seed=0)


def test_a_zipped_value_may_come_twice_as_long_as_no_point_does():
    assert build("zip", [axis("a", "1,1,2"), axis("b", "3,4,3")], points=None, seed=0).count == 3


def test_a_long_range_is_never_written_out():
    values = parse("key", "0:1e9:1")
    assert isinstance(values, Steps)
    assert len(values) == 10**9 + 1
    assert len(json.dumps(values.canonical())) < 100
    assert isinstance(parse("key", "0:1e9"), Between)


def test_the_same_points_are_the_same_sweep_however_they_are_written(tmp_path):
    first = plan(tmp_path, "runs", "value=4:8:2", "name=ant,bee")
    assert plan(tmp_path, "runs", "value=8,4,6", "name=ant,bee").digest == first.digest
    for other in (
        ["value=4:8:4", "name=ant,bee"],
        ["value=4:8:2"],
        ["value=4:8:2", "name=ant,bee", "seed=1"],
    ):
        assert plan(tmp_path, "runs", *other).digest != first.digest
    assert plan(tmp_path, "runs", "value=4:8:2", "name=bee,ant,bee", kind="zip").digest != first.digest


def test_the_config_of_a_point_is_that_of_a_run_with_its_values(tmp_path):
    sweep = plan(tmp_path, "runs", "wait=0.5", "value=4:8:2", "name=ant,bee")
    config = sweep.points.load(sweep.points.codes(3)).config
    assert (config.value, config.name, config.wait) == (6, "bee", 0.5)
    assert sweep.folder.name == f"runs-sweep-{sweep.digest[:8]}"


@pytest.mark.parametrize(
    ("values", "says"),
    [
        (["valeu=1,2"], "did you mean `value`?"),
        (["value=1,2000000"], "at most 1e+06, but is 2000000"),
        (["value=0.5,1"], "must be a whole number, but is 0.5"),
        (["value=-5:5:1"], "at least 0, but is -5"),
        (["name=ant,cat"], "must be `ant` or `bee`, but is 'cat'"),
        (["value=1,2", "value=3,4"], "given 2 times"),
        (["experiment=runs,batch"], "cannot be swept"),
        (["value"], "must read key.path=values"),
        (["wait=-1", "value=1,2"], "at least 0 s, but is -1"),
        ([], "Nothing is swept"),
    ],
)
def test_bad_points_are_refused_before_anything_starts(tmp_path, values, says):
    with pytest.raises(UserError) as error:
        plan(tmp_path, "runs", *values)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
    assert not (tmp_path / "sweeps").exists()


def test_the_files_that_swept_keys_name_are_part_of_the_identity(tmp_path, monkeypatch):
    monkeypatch.setattr("_sweep_toys.RunsConfig.inputs", lambda self: (self.log,) if self.log else ())
    files = [tmp_path / "one", tmp_path / "two"]
    for file in files:
        file.write_text("1")
    values = f"log={files[0]},{files[1]}"
    before = plan(tmp_path, "runs", values).digest
    assert plan(tmp_path, "runs", values).digest == before
    files[1].write_text("2")
    assert plan(tmp_path, "runs", values).digest != before


def test_an_interval_draws_whole_numbers_only_for_keys_that_hold_them(tmp_path):
    whole = plan(tmp_path, "runs", "value=1:9", kind="random", points=50).points.design
    assert set(points(whole)[:, 0]) == set(range(1, 10))
    real = points(plan(tmp_path, "batch", "x=1:9", kind="random", points=50).points.design)
    assert len(np.unique(real)) == 50
