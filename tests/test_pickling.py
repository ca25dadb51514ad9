"""Shapes and spaces as arguments and results of other processes, and copied: each is then what its file would say."""

from __future__ import annotations

import pickle
from copy import copy, deepcopy
from dataclasses import replace

import numpy as np
import pytest
from conftest import EQUAL, pipes, solved
from test_kinds import bend, every_kind, sample
from test_one_mesh import TRADED

import pas
from pas import solid
from pas.elsewhere import elsewhere
from pas.shape import KINDS
from pas.verdicts import Findings, Status, Verdict

FORGED = Findings((Verdict(Status.PROVED, "everything", "somebody said so"),))


def through_pickle(thing):
    return pickle.loads(pickle.dumps(thing))


@every_kind
def test_a_pickled_shape_is_what_its_file_says(name):
    shape, form = sample(name), KINDS[name].form
    again = through_pickle(shape)
    assert type(again) is type(shape) and again is not shape
    assert form.write(again) == form.write(shape)
    assert again.certificate.verdicts == shape.certificate.verdicts


def test_shapes_of_every_kind_go_to_another_process_and_come_back():
    shapes = {name: sample(name) for name in KINDS}
    for name, again in elsewhere("copying", "copy:copy", shapes).items():
        assert KINDS[name].form.write(again) == KINDS[name].form.write(shapes[name]), name


@every_kind
def test_shapes_are_copied_as_values(name):
    shape = sample(name)
    assert copy(shape) is shape
    assert (deepcopy({"shape": [shape]})["shape"][0] is shape) == (name != "mesh")


def test_arrays_of_a_deep_copy_of_a_mesh_are_its_own():
    mesh = solid.ball((0, 0, 0), 1).mesh(0.1)
    again = deepcopy(mesh)
    again.points[:] *= 2
    assert np.array_equal(again.points, 2 * mesh.points)
    assert (again.deviation, again.names) == (mesh.deviation, mesh.names)


@every_kind
def test_no_verdict_that_was_found_before_goes_along(name, monkeypatch):
    shape = sample(name)
    found = shape.certificate
    if "certificate" in vars(shape):
        monkeypatch.setitem(vars(shape), "certificate", FORGED)
    again = through_pickle(shape)
    assert "certificate" not in vars(again)
    assert again.certificate.verdicts == found.verdicts


def test_verdicts_of_a_blend_go_along_as_those_of_a_file(monkeypatch):
    blend = solved(EQUAL, 1)
    found = blend.certificate
    monkeypatch.setitem(vars(blend.surface), "certificate", replace(found, one_sheet=FORGED.verdicts[0]))
    again = through_pickle(blend)
    assert again.stored.one_sheet == FORGED.verdicts[0]
    assert again.standing == "not proved yet" and again.certificate == found


def test_meshes_keep_how_near_they_are_and_prove_it_anew():
    for name in TRADED:
        mesh = TRADED[name]().mesh(3e-2)
        proved = mesh.certificate
        vars(mesh)["certificate"] = FORGED
        again = through_pickle(mesh)
        assert type(again) is type(mesh) and again.deviation == mesh.deviation
        assert np.array_equal(again.points, mesh.points) and np.array_equal(again.normals, mesh.normals)
        assert again.certificate.verdicts == proved.verdicts


def test_meshes_of_networks_and_fitted_patches_go_along():
    mesh = bend().blend(1, "lowest").mesh()
    assert through_pickle(mesh).certificate.verdicts == mesh.certificate.verdicts
    patch = pas.fit_patch(pas.torus(2, 1), 0.1, ((-1, 1), (-1, 1)))
    assert through_pickle(patch).deviation == patch.deviation


def test_members_are_chosen_in_other_processes():
    space = pas.solutions(pipes(EQUAL), 1, 4)
    again = through_pickle(space)
    assert again.patches == space.patches and again.degrees_tried == space.degrees_tried
    wishes = pas.Wishes(tension=2, prove=False)
    assert through_pickle(again.fit(wishes)).surface.polynomials == space.fit(wishes).surface.polynomials


def test_what_no_file_keeps_is_refused_in_a_sentence():
    surface = pas.ParametricSurface(lambda t, h: t, lambda t, h: h, lambda t, h: t * h, domain=((0, 1), (0, 1)))
    with pytest.raises(ValueError, match="a surface without expressions cannot be saved"):
        pickle.dumps(surface)
