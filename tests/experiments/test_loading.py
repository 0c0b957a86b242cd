"""Configs: what is accepted, and the one sentence for what is not."""

import math

import pytest

from experiments.harness._errors import UserError
from experiments.harness._loading import load, shipped
from experiments.schema import DEFAULT_BREAKING_WAVENUMBER, JonswapConfig, MitsuyasuSpreading

BAD_OVERRIDES = {
    "wind.sped=3": "Unknown key `wind.sped` on the command line: did you mean `wind.speed`?",
    "wnd.speed=3": "Unknown key `wnd` on the command line: did you mean `wind`?",
    "speed=3": "Unknown key `speed` on the command line: did you mean `wind.speed`?",
    "spectrum.peak_period=3": "belongs to another choice of `spectrum.family`",
    "wind.speed=-3": "Key `wind.speed` on the command line must be at least 0 m/s, but is -3.",
    "wind.speed=abc": "must be a number, but is 'abc'",
    "wind.speed=true": "must be a number, but is true",
    "wind.speed='10'": "must be a number, but is '10'",
    "wind.speed=.nan": "must be a finite number",
    "wind.speed=.inf": "must be a finite number",
    "wind.speed=": "must be a number, but is null",
    "wind=3": "Key `wind` on the command line must be a section of keys, but is 3",
    "wind.drag=foo": "must be `elfouhaily` or `wu`, but is 'foo'",
    "cascade.resolution=255": "must be even, but is 255",
    "cascade.resolution=1000000": "must be at most 4096, but is 1000000",
    "cascade.resolution=20.5": "must be a whole number, but is 20.5",
    "cascade.sizes=[893,-101]": "must hold lengths greater than 0 m and at most 1e7 m, but one is -101",
    "cascade.sizes=[893,.nan]": "must be a finite number",
    "cascade.sizes=[]": "must hold at least 1",
    "cascade.sizes=[a]": "Key `cascade.sizes.0` on the command line must be a number",
    "cascade.bands=[[1,2],[1.5,3],[3,4],[4,5]]": "follow each other exactly, but overlap between 2 and 1.5",
    "cascade.bands=[[1,2],[2.5,3],[3,4],[4,5]]": "must follow each other exactly, but leave a gap",
    "cascade.bands=[[1,1],[1,3],[3,4],[4,5]]": "0 < lower < upper, but one is [1, 1]",
    "cascade.bands=[[1,2]]": "must hold one band per pattern (4), but holds 1",
    "choppiness=[1,1,1,1,1]": "must be one number or one per pattern (4, as in `cascade.sizes`), but holds 5",
    "choppiness=abc": "must be a number or a list, but is 'abc'",
    "choppiness=[1,b,1,1]": "Key `choppiness.1` on the command line must be a number",
    "choppiness=-1": "must lie between 0 and 20, but is -1",
    "breaking_wavenumber=0": "must be greater than 0 rad/m, but is 0",
    "spectrum.family=jonswp": "must be one of `elfouhaily`, `pierson_moskowitz`, `jonswap`",
    "spectrum={family: jonswap, peak_period: 8}": "given together with `peak_period`",
    "wind.speed=${oc.env:HOME}": "must be a number, but is '${oc.env:HOME}'",
    "wind.speed=???": "must be a number",
    "wind.speed=[": "cannot be applied",
    "abc": "must read key.path=value",
    "=3": "must read key.path=value",
    "seed=-1": "must be at least 0, but is -1",
    "title=3": "must be a text, but is 3",
    "experiment=spectrm": "There is no experiment `spectrm`: did you mean `spectrum`?",
}


@pytest.mark.parametrize(("override", "says"), BAD_OVERRIDES.items(), ids=list(BAD_OVERRIDES))
def test_a_bad_override_is_one_clear_sentence(override, says):
    with pytest.raises(UserError) as error:
        load("spectrum", [override])
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_a_bad_key_in_a_file_names_the_file(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("experiment: spectrum\nwind:\n  speed: -1\n")
    with pytest.raises(UserError, match=rf"Key `wind.speed` in {path} must be at least 0 m/s, but is -1"):
        load(str(path))


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("experiment: spectrum\nwind: [", "is not valid YAML"),
        ("experiment: spectrum\nseed: 1\nseed: 2\n", "is not valid YAML: found duplicate key"),
        ("wind: {speed: 3}", "lacks the key `experiment`"),
        ("- 1\n- 2\n", "must hold `key: value` lines"),
        ("experiment: nothing_like_it", "There is no experiment `nothing_like_it`"),
        ("experiment: spectrum\nwind: !!python/object/apply:os.getcwd []", "is not valid YAML"),
        ("", "lacks the key `experiment`"),
        ("hello", "lacks the key `experiment`"),
        (
            "experiment: spectrum\nspectrum: {half_plane: true}",
            "chooses among the kinds of `spectrum`",
        ),
    ],
)
def test_a_bad_file_is_one_clear_sentence(tmp_path, content, says):
    path = tmp_path / "mine.yaml"
    path.write_text(content)
    with pytest.raises(UserError) as error:
        load(str(path))
    assert says in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_text_is_refused(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(UserError, match="UTF-8"):
        load(str(path))


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("spectrun", "did you mean `spectrum`?"),
        ("zzz", "`jaxocean list` shows all of them"),
        ("there/is/none.yaml", "does not exist"),
        ("/tmp/", "is a folder"),
    ],
)
def test_a_missing_config_is_one_clear_sentence(name, says):
    with pytest.raises(UserError, match="config") as error:
        load(name)
    assert says in str(error.value)


@pytest.mark.parametrize("path", shipped(), ids=lambda path: path.stem)
def test_every_shipped_config_is_valid_and_says_what_it_does(path):
    loaded = load(path.stem)
    assert loaded.config.title
    assert load(str(path)) == loaded


def test_overrides_reach_into_sections_and_lists():
    config = load("spectrum", ["wind.speed=12", "cascade.sizes.0=900", "choppiness=[1,1,0.5,0.5]"]).config
    assert config.wind.speed == 12.0
    assert config.cascade.sizes == (900.0, 101.0, 21.0, 11.0)
    assert config.choppiness == (1.0, 1.0, 0.5, 0.5)


def test_a_change_of_family_starts_from_the_new_familys_defaults():
    overrides = ["spectrum.inverse_wave_age=2", "spectrum.family=jonswap", "spectrum.peak_enhancement=5"]
    config = load("spectrum", overrides).config
    assert isinstance(config.spectrum, JonswapConfig)
    assert config.spectrum.peak_enhancement == 5.0
    assert config.spectrum.spreading == MitsuyasuSpreading()


def test_the_default_breaking_wavenumber_is_what_the_default_cascade_resolves():
    assert math.pi * 256 / 11 == DEFAULT_BREAKING_WAVENUMBER


def test_configs_are_frozen():
    config = load("spectrum").config
    with pytest.raises(ValueError, match="frozen"):
        config.seed = 3
