"""What is made of a result: data frames, meshes, pictures and images."""

import json
import subprocess
import sys

import mtled
import numpy as np
import pytest

BRAIN = "brain_slice"


@pytest.fixture(scope="module")
def brain(label_map):
    """A coarse slice of brain that is pushed."""
    return mtled.load(BRAIN, overrides={"time.end": 0.5, "discretisation.spacing": 0.006}).solve(error_bars=False)


def test_histories_are_a_data_frame(cube, here):
    pandas = pytest.importorskip("pandas")
    frame = cube.to_pandas()
    cube.write("out")
    written = pandas.read_csv("out/history.csv")
    assert list(frame.columns) == list(written.columns) and "time_s" in frame
    assert np.allclose(frame.to_numpy(), written.to_numpy(), rtol=1e-14)
    probes = cube.to_pandas("probes")
    assert {"probe", "x_m", "uz_m"} < set(probes.columns) and len(probes) == sum(
        len(places) for places, _ in cube.probes.values()
    )
    assert list(cube.to_pandas("reactions")["condition"]) == list(cube.reactions_n)
    with pytest.raises(ValueError, match="history, probes and reactions"):
        cube.to_pandas("nothing")


def test_the_mesh_to_look_at_is_that_of_the_files(cube, here):
    pyvista = pytest.importorskip("pyvista")
    cube.write("out")
    written = pyvista.read(max(here.glob("out/body_*.vtu")))
    grid = cube.to_pyvista()
    assert grid.n_cells == written.n_cells and grid.n_points == written.n_points
    assert np.array_equal(grid.points, written.points)
    assert np.array_equal(grid.cells, written.cells)
    for name in grid.point_data:
        assert np.allclose(grid.point_data[name], written.point_data[name], rtol=1e-6, atol=1e-30), name
    assert np.array_equal(grid.cell_data["region"], written.cell_data["region"])
    moved = cube.to_pyvista(deformed=True)
    assert moved.bounds[5] == pytest.approx(grid.bounds[5] - 0.02, abs=1e-4)


def test_a_picture_is_drawn_by_a_field(cube, here):
    cube.picture("cube.svg", field="von_mises_stress")
    assert "<svg" in (here / "cube.svg").read_text()
    assert "<svg" in cube.picture()._repr_svg_()
    with pytest.raises(ValueError, match="there are displacement, J"):
        cube.picture(field="temperature")


def test_a_case_without_frames_says_that_it_has_no_mesh():
    result = mtled.load("uniaxial_bar", overrides={"output.frames": 0}).solve(error_bars=False)
    with pytest.raises(ValueError, match=r"output\.frames"):
        result.picture()


def test_a_label_map_is_warped_as_the_program_warps_it(brain, label_map, here):
    warped = brain.warp(label_map, labels=True)
    assert warped.voxels.shape == (157, 190, 5) and warped.voxels.dtype == np.uint8
    assert set(np.unique(warped.voxels)) == {0, 1, 2, 3}
    # Of 149 150 voxels, five in each layer beside a fold of the surface, across which the field jumps.
    assert warped.unconverged <= 25 and warped.nodes_outside == 0
    assert np.shares_memory(warped.voxels, warped.voxels)
    assert np.abs(warped.source_vectors_m).max() == pytest.approx(np.abs(brain.displacement_m).max(), rel=0.2)
    warped.write("labels.nrrd")
    warped.write_inverse_field("field.nrrd")

    brain.write("out")
    command = [sys.executable, "-m", "mtled", "warp", "out", "--image", str(label_map), "--labels", "--quiet"]
    subprocess.run([*command, "--out", "same.nrrd", "--inverse-field", "same_field.nrrd"], check=True)
    assert (here / "labels.nrrd").read_bytes() == (here / "same.nrrd").read_bytes()
    assert (here / "field.nrrd").read_bytes() == (here / "same_field.nrrd").read_bytes()


def test_an_image_of_another_space_or_format_is_an_image_error(cube, label_map, here):
    with pytest.raises(mtled.ImageError, match="none of the nodes of the body lies in this image"):
        mtled.load("twisted_cylinder", overrides={"output.frames": 0}).solve(error_bars=False).warp(
            label_map, unit="um"
        )
    with pytest.raises(mtled.ImageError, match="nowhere.nrrd"):
        cube.warp("nowhere.nrrd")
    with pytest.raises(ValueError, match="is no unit"):
        cube.warp(label_map, unit="km")


def test_results_are_json(cube):
    assert json.loads(json.dumps(cube.json)) == cube.json
    assert cube.json["motion"]["outcome"] == "converged" and "mm" not in cube.json
    assert "nodes" in str(cube)
