"""Energies: every registered one is exact, scales with the model, and goes through files and TOML."""

from __future__ import annotations

import json
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import ClassVar

import numpy as np
import pytest
from conftest import ROOT, UNEQUAL, pipes
from flint import fmpq

import pas
from pas.fairing.basis import to_doubles
from pas.fairing.energy import ENERGIES, QUADRATIC, read_energy

BOX = pas.Box(("1/4", "-1/5", "-1/5"), ("1/2", "1/5", "1/5"))
SAMPLES = {
    "thin-plate": [pas.ThinPlate(), pas.ThinPlate(weight="3/7"), pas.ThinPlate(BOX, 2, 5)],
    "membrane": [pas.Membrane(), pas.Membrane(weight="3/7"), pas.Membrane(BOX, 2, 5)],
    "combination": [pas.ThinPlate() + 2 * pas.Membrane(BOX), "1/3" * pas.Membrane()],
}
ALL = [energy for energies in SAMPLES.values() for energy in energies]
SAMPLES["curvature-variation"] = [pas.CurvatureVariation(), pas.CurvatureVariation("7/3", 2)]
"""Those of the surface have tests of their own."""
WORDS = [f"{energy.kind} {number}" for number, energy in enumerate(ALL)]
FAR = [
    pas.Pipe((5, 0, 0), 3, 2, (100, 0, 0)),
    pas.Pipe((0, 1, 0), 4, 12, (100, 0, 0)),
    pas.Pipe((0, 0, 1), 2, 9, (100, 0, 0)),
]


def toml(record) -> str:
    """A record as an inline table of TOML."""
    if isinstance(record, dict):
        return "{" + ", ".join(f"{key} = {toml(value)}" for key, value in record.items()) + "}"
    return "[" + ", ".join(map(toml, record)) + "]" if isinstance(record, list) else repr(record).replace("'", '"')


@pytest.fixture(scope="module")
def space():
    return pas.solutions(pipes(UNEQUAL), 1, 4)


def test_every_registered_energy_is_tested_here():
    assert set(SAMPLES) == {kind for kind, made in ENERGIES.items() if made.__module__.startswith("pas.")}
    assert all(energy.kind == kind for kind, energies in SAMPLES.items() for energy in energies)
    assert QUADRATIC in ENERGIES


@pytest.mark.sampled(2)
@pytest.mark.parametrize("energy", ALL, ids=WORDS)
def test_the_exact_form_is_the_one_that_is_made_small(space, energy):
    """Two ways, moments or Gram matrices and Gauss rules, and a frame far from the origin."""
    spaces = [space] if "Box" in repr(energy) else [space, pas.solutions(FAR, 1, 4)]
    for each in spaces:
        form = each.prepared.form(energy)
        change = each.prepared.basis.transform
        expected = to_doubles(change * energy.products(each) * change.transpose())
        assert np.abs(form - expected).max() <= 1e-11 * np.abs(expected).max()
        assert np.linalg.eigvalsh(form).min() >= -1e-12 * np.abs(form).max()


@pytest.mark.parametrize("energy", ALL, ids=WORDS)
@pytest.mark.sampled(3)
def test_nothing_chosen_by_another_energy_has_less(space, energy):
    options = {"prove": False, "guard": False}
    best = space.fit(energy=energy, **options)
    assert best.wishes.energy == best.plate == energy
    matrix = space.energy_matrix(energy)

    def measured(blend):
        pairs = product(enumerate(blend.coefficients), repeat=2)
        return float(sum(matrix[i][j] * a * b for (i, a), (j, b) in pairs) / 2)

    assert best.energy == pytest.approx(measured(best), rel=1e-9)
    for other in (pas.ThinPlate(), pas.Membrane()):
        # over the small box of one patch some member has no energy but for rounding
        assert measured(space.fit(energy=other, **options)) >= best.energy * (1 - 1e-6) - 1e-12


@pytest.mark.parametrize("energy", [*ALL, SAMPLES["curvature-variation"][1], pas.CurvatureVariation() + ALL[0] / 7])
@pytest.mark.sampled(3)
def test_files_and_toml(space, energy, tmp_path):
    blend = space.fit(energy=energy, prove=False, guard=energy.on_surface)
    again = pas.load(blend.save(tmp_path / "a.pas.json"))
    assert again.wishes.energy == energy
    assert hash(again.wishes.energy) == hash(energy)
    problem = tmp_path / "a.toml"
    text = (ROOT / "examples/corners/unequal_gc1.toml").read_text()
    problem.write_text(f"energy = {toml(energy.to_record())}\n{text}")
    assert pas.read_problem(problem).wishes.energy == energy


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kind": "bending"}, "kind: there is no energy 'bending'"),
        ({"kind": 3}, r"content\.problem\.energy\.kind must be a text"),
        ({"wieght": 1}, "'wieght' does not belong to the energy 'membrane'"),
        ({"weight": [1]}, "weight must be"),
        ({"lower": "0", "upper": "1"}, "lower must be three numbers"),
    ],
)
def test_project_files_with_other_energies_are_refused(space, tmp_path, change, words):
    path = space.fit(energy=pas.Membrane(), prove=False, guard=False).save(tmp_path / "a.pas.json")
    record = json.loads(path.read_text())
    record["content"]["problem"]["energy"].update(change)
    path.write_text(json.dumps(record))
    with pytest.raises(pas.ProjectFileError, match=words):
        pas.load(path, edited=True)


@pytest.mark.parametrize("kind", ["thin-plate", "membrane"])
@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"weight": "-1"}, "weight must not be negative"),
        ({"weight": "one"}, "weight"),
        ({"wieght": 1}, "'wieght' does not belong to the energy '.*'; is 'weight' meant"),
        ({"lower": [0, 0, 0]}, "both lower and upper"),
        ({"piece": -1}, "piece must be a whole number from 0"),
        ({"lower": [0, 0, 0], "upper": [0, 1, 1]}, "below the upper one"),
    ],
)
def test_bad_tables_are_refused(kind, table, words):
    with pytest.raises(ValueError, match=words):
        read_energy({"kind": kind, **table})


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"kind": "thinplate"}, "kind: there is no energy 'thinplate'; is 'thin-plate' meant"),
        ({"kind": ["membrane"]}, "kind: there is no energy"),
        ({"kind": "combination"}, "the energy 'combination' needs 'terms'"),
        ({"kind": "combination", "terms": []}, "terms must hold at least one energy"),
        ({"kind": "combination", "terms": {}}, "terms must be a list of tables"),
        ({"kind": "combination", "terms": [{"times": 1}]}, "terms must be a list of tables"),
        ({"kind": "combination", "terms": [{"times": 1, "energy": 2}]}, "terms must have energies that are tables"),
        ({"kind": "combination", "terms": [{"times": -1, "energy": {}}]}, "terms must have multiples that are not"),
    ],
)
def test_bad_kinds_and_terms_are_refused(table, words):
    with pytest.raises(ValueError, match=words):
        read_energy(table)


def test_sums_and_multiples():
    plate, membrane = pas.ThinPlate(), pas.Membrane(weight=2)
    assert (plate + membrane).terms == ((fmpq(1), plate), (fmpq(1), membrane))
    assert (3 * (plate + membrane * 2) * "1/2").terms == ((fmpq(3, 2), plate), (fmpq(3), membrane))
    with pytest.raises(ValueError, match="not negative"):
        _ = -1 * plate
    with pytest.raises(TypeError):
        _ = plate + 1


def test_the_membrane_of_known_functions():
    """f = x y over a box of volume 8: the integral of y^2 + x^2 is 2 * 8/3."""
    cell = pas.SingleCell((-1, -1, -1), (1, 1, 1))
    space = pas.solutions([("x*y", "z - 1")], 0, 2, pas.SingleCell())
    (row,) = space.restricted(["x*y"]).energy_matrix(pas.Membrane(pas.Box((-1, -1, -1), (1, 1, 1))))
    assert row == [Fraction(16, 3)]
    with pytest.raises(ValueError, match="an energy needs a region"):
        space.energy_matrix(pas.Membrane())
    assert cell.box is not None


def test_wrong_forms_are_refused(space):
    @dataclass(frozen=True)
    class Wrong(pas.Energy):
        kind: ClassVar[str] = "wrong"
        value: float = 0.0

        def hessian(self, basis):
            return np.full((2, 2), self.value)

    with pytest.raises(ValueError, match="the energy 'wrong' must give a finite matrix of shape"):
        space.fit(energy=Wrong())
    with pytest.raises(ValueError, match="the energy 'wrong' has no exact form"):
        space.energy_matrix(Wrong())
    with pytest.raises(TypeError, match=r"energy must be a subclass of pas\.Energy"):
        pas.register_energy(Wrong())
    with pytest.raises(ValueError, match="'membrane' already"):
        pas.register_energy(type("Again", (pas.Membrane,), {}))
