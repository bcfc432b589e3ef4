"""What goes wrong ends as the exception that fits."""

import _thread
import pickle
import signal
import threading
import time

import mtled
import pytest
from conftest import CUBE

TEXT = mtled.bundled()[CUBE]


def test_a_bad_key_is_a_case_error_with_its_place(here):
    (here / "bad.toml").write_text(TEXT.replace("density", "densty"))
    with pytest.raises(mtled.CaseError, match="did you mean `density`") as caught:
        mtled.load("bad.toml")
    error = caught.value
    line = next(n for n, text in enumerate(TEXT.splitlines(), 1) if text.startswith("density"))
    assert (error.file, error.line, error.column) == ("bad.toml", line, 1)
    assert error.key.startswith("material.") and error.key.endswith(".densty")
    assert error.mistakes[0].message in str(error)


def test_a_bad_override_names_the_override():
    with pytest.raises(mtled.CaseError) as caught:
        mtled.load(CUBE, overrides={"discretisation.spacng": 0.01})
    assert caught.value.key == "discretisation.spacng" and caught.value.file == "command line"


def test_all_mistakes_are_listed():
    text = TEXT.replace("density = 1000.0", "density = -1.0").replace("spacing = 0.0125", "spacing = -1.0")
    with pytest.raises(mtled.CaseError) as caught:
        mtled.Case.from_text(text)
    assert {"material", "discretisation"} <= {mistake.key.split(".")[0] for mistake in caught.value.mistakes}


def test_a_file_that_is_not_there_is_a_case_error():
    with pytest.raises(mtled.CaseError, match="there is no such file"):
        mtled.load("nowhere.toml")


def test_a_refused_recipe_is_a_set_up_error_at_its_key():
    case = mtled.load(CUBE, overrides={"discretisation.grid": {"cells_per_spacing": 0.4}})
    for work in (case.solve, case.discretise):
        with pytest.raises(mtled.SetUpError) as caught:
            work()
        assert caught.value.key == "discretisation.grid" and caught.value.file


def test_a_run_without_a_solution_is_a_solve_error_with_its_outcome():
    overrides = {"time": {"method": "static", "solver": "relaxation", "max_steps": 5}}
    with pytest.raises(mtled.SolveError) as caught:
        mtled.load(CUBE, overrides=overrides).solve()
    assert caught.value.outcome == "not_converged" and caught.value.key == "time"


def test_every_error_is_an_mtled_error_and_can_be_sent_to_another_process():
    place = ("a.toml", 1, 2, "time", "is wrong")
    for error in (
        mtled.CaseError("text", [place]),
        mtled.SetUpError("text", [place]),
        mtled.SolveError("text", [place], "diverged"),
        mtled.ImageError("text"),
    ):
        assert isinstance(error, mtled.MtledError)
        copy = pickle.loads(pickle.dumps(error))
        assert type(copy) is type(error) and str(copy) == "text" and vars(copy) == vars(error)


@pytest.mark.parametrize("spacing_m", [0.006, 0.0025], ids=["in the run", "in the set-up"])
def test_ctrl_c_ends_a_run_at_once(spacing_m):
    # A shell that starts programs in the background lets them ignore it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    case = mtled.load(CUBE, overrides={"discretisation.spacing": spacing_m, "time.solver": "relaxation"})
    pressed = []
    timer = threading.Timer(0.5, lambda: (pressed.append(time.monotonic()), _thread.interrupt_main()))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        case.solve()
    assert time.monotonic() - pressed[0] < 1.0


def test_what_the_progress_raises_ends_the_run():
    def progress(fraction, step):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        mtled.load(CUBE, overrides={"time.solver": "relaxation"}).solve(progress=progress)


def test_values_that_no_case_has_are_type_errors():
    with pytest.raises(TypeError, match="not object"):
        mtled.load(CUBE, overrides={"title": object()})
