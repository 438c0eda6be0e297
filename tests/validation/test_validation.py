"""Published values beside computed ones: the rule of agreement, the page, and the command."""

import csv

import numpy as np
import pytest
from typer.testing import CliRunner

from tractive_sam.cli.program import app
from tractive_sam.validation import (
    TOPICS,
    PublishedSet,
    Topic,
    Verdict,
    check_locus,
    report,
    select_sets,
    validate,
)
from tractive_sam.validation.comparison import Comparison, compare
from tractive_sam.validation.wheel_rail import CONICITY_CASES

SETS = [one for topic in TOPICS for one in topic.sets]


@pytest.mark.parametrize(
    ("published", "computed", "error", "agrees"),
    [
        ("0.65", 0.6549, 0.0, True),
        ("0.650", 0.6506, 0.0, False),  # half a unit of the last digit
        ("0.650", 0.6506, 1e-3, True),
        ("1.005e+04", 10_054.9, 0.0, True),
        ("-0.29", -0.2949, 0.0, True),
        ("4750", 4750.6, 0.0, False),
        (0.5, 0.5001, 1e-4, False),  # a closed form has all digits
        (0.5, 0.50004, 1e-4, True),
    ],
)
def test_agreement_follows_from_the_published_digits(published, computed, error, agrees):
    assert compare("q", published, computed, error).agrees is agrees


def test_the_error_can_be_relative_to_another_size():
    assert not compare("q", 0.0, 1e-3, 1e-2).agrees
    assert compare("q", 0.0, 1e-3, 1e-2, scale=1.0).agrees


def test_every_set_names_its_source_and_is_found_by_its_title():
    titles = [(one.title, one.source) for one in SETS]
    assert len(set(titles)) == len(titles) >= 60
    assert all(one.source for one in SETS)
    for one in SETS:
        (found, *_) = select_sets(words=[one.title])
        assert one in found.sets


@pytest.mark.slow
def test_the_quick_half_agrees(tmp_path):
    topics = select_sets(quick=True)
    outcomes = validate(tmp_path, topics)
    assert [outcome.of for outcome in outcomes] == [one for topic in topics for one in topic.sets]
    bad = [outcome.of.title for outcome in outcomes if outcome.worst is Verdict.DIFFERS]
    assert not bad
    assert not [outcome.failure for outcome in outcomes if outcome.failure]
    explained = [o.of.title for o in outcomes if o.worst is Verdict.EXPLAINED]
    assert explained == ["Twin discs R8T on UIC60 900A: frictional heat"]


def test_reference_conicities_from_radius_differences():
    """The differences of E7 end at 6.8 mm, and its motions are about y = -2.7 mm."""
    for case, number in ((CONICITY_CASES[0], 59), (CONICITY_CASES[6], 42)):
        check = case.check(from_profiles=False)
        # Differences in micrometres and conicities in thousandths.
        np.testing.assert_allclose(check.conicity, check.reference, rtol=1e-3, atol=5e-4)
        assert check.amplitude.size == number


def test_reference_conicities_from_profiles():
    """Wheels H are cones of 0.025 up to the jump at 2.5 mm; the standard places it later."""
    check = CONICITY_CASES[2].check()
    np.testing.assert_allclose(check.conicity[:10], 0.025, atol=1e-6)  # points in nm
    assert check.amplitude[~check.agrees].tolist() == [2.6]
    assert "jumps at |y| = 2.496 mm" in check.reasons[16]
    assert not check.differs.any()
    values = list(CONICITY_CASES[2].compare(from_profiles=True))
    assert [value.agrees for value in values] == [True] * 14


def test_reasons_of_values_explain_them():
    def jumping():
        yield Comparison("explained", "1.0", 2.0, 0.5, 1.0, "the contact jumps")

    outcome = PublishedSet("x", "y", jumping).run()
    assert outcome.worst is Verdict.EXPLAINED


def test_unknown_standards_are_refused():
    with pytest.raises(ValueError, match="allowed: EN15302"):
        check_locus("EN13674")


def wrong():
    yield compare("right", "1.0", 1.04)
    yield compare("wrong", "1.0", 1.06)


def unsolved():
    yield compare("right", "1.0", 1.0)
    raise RuntimeError("out of memory")


def interrupted():
    raise KeyboardInterrupt


WRONG = PublishedSet("A wrong <set>", "Author 1900", wrong)
EXPLAINED = PublishedSet("An explained set", "Author 1901", wrong, explanation="Known why.")
UNSOLVED = PublishedSet("A failing set", "Author 1902", unsolved)


def test_verdicts():
    assert WRONG.run().worst is Verdict.DIFFERS
    assert EXPLAINED.run().worst is Verdict.EXPLAINED
    failed = UNSOLVED.run()
    assert failed.worst is Verdict.FAILED
    assert failed.failure == "out of memory"
    assert [one.agrees for one in failed.comparisons] == [True]


def test_the_page_and_the_table_contain_every_value(tmp_path):
    validate(tmp_path, [Topic("Authors", (WRONG, EXPLAINED, UNSOLVED))])
    page = (tmp_path / "index.html").read_text("utf-8")
    for text in ("A wrong &lt;set&gt;", "Author 1901", "Known why.", "out of memory", "differs"):
        assert text in page
    assert "src=" not in page  # it needs no other file
    rows = list(csv.DictReader((tmp_path / "comparisons.csv").read_text("utf-8").splitlines()))
    assert [row["verdict"] for row in rows] == [
        "agrees", "differs", "agrees", "differs, explained", "agrees", "not computed",
    ]  # fmt: skip
    assert float(rows[1]["difference"]) == pytest.approx(0.06)


def test_an_interrupted_computation_keeps_the_sets_so_far(tmp_path):
    topic = Topic("Authors", (WRONG, PublishedSet("x", "y", interrupted), EXPLAINED))
    with pytest.raises(KeyboardInterrupt):
        validate(tmp_path, [topic])
    page = (tmp_path / "index.html").read_text("utf-8")
    assert "2 sets are missing" in page
    assert len((tmp_path / "comparisons.csv").read_text("utf-8").splitlines()) == 3


class TestCommand:
    def run(self, tmp_path, *arguments):
        return CliRunner().invoke(app, ["validate", *arguments, "-o", str(tmp_path / "out")])

    def test_sets_by_a_word(self, tmp_path):
        ran = self.run(tmp_path, "cattaneo")
        assert ran.exit_code == 0, ran.output
        assert "Shift of spheres" in ran.stdout
        assert "1 published sets, 1 values: 1 agree" in ran.stderr
        assert ran.stdout.splitlines()[-1].endswith("index.html")

    def test_a_word_that_does_not_occur(self, tmp_path):
        ran = self.run(tmp_path, "Newton's apple")
        assert ran.exit_code == 2
        assert "WORD" in ran.stderr
        assert not (tmp_path / "out").exists()

    def test_a_set_that_is_not_quick(self, tmp_path):
        ran = self.run(tmp_path, "--quick", "five meshes")
        assert ran.exit_code == 2
        assert "--quick" in ran.stderr

    def test_a_difference_without_an_explanation(self, tmp_path, monkeypatch):
        monkeypatch.setattr(report, "TOPICS", (Topic("Authors", (WRONG,)),))
        ran = self.run(tmp_path)
        assert ran.exit_code == 3
        assert (tmp_path / "out" / "index.html").exists()

    def test_an_output_that_is_a_file(self, tmp_path):
        (tmp_path / "out").write_text("mine")
        ran = self.run(tmp_path, "cattaneo")
        assert ran.exit_code == 2
        assert (tmp_path / "out").read_text() == "mine"
