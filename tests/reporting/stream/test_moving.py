"""What moves, read back."""

import numpy as np

from tests.reporting.stream.streams import read
from tsas_cli.reporting.stream.recorder import Clock, moving, to_file

TIMES = Clock().times(np.array([0.0, 0.5, 1.25]))
AT = ("run", "a", "tendon")


def recorded(tmp_path, record):
    with to_file(tmp_path / "s.rrd", "x") as recorder:
        record(recorder)
    return read(tmp_path / "s.rrd")["/run/a/tendon"]


def test_a_surface_keeps_its_triangles_and_changes_corners_and_colours(tmp_path):
    corners = np.arange(36.0).reshape(3, 4, 3)
    colours = np.arange(12, dtype=np.uint32).reshape(3, 4)
    triangles = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.uint32)
    found = recorded(tmp_path, lambda r: moving.surface(r, AT, TIMES, corners, triangles, colours))
    assert found.static["Mesh3D:triangle_indices"] == triangles.tolist()
    assert found.rows["Mesh3D:vertex_positions"] == corners.tolist()
    assert found.rows["Mesh3D:vertex_colors"] == colours.tolist()
    assert found.at().tolist() == [0, 500_000_000, 1_250_000_000]


def test_any_number_of_curves_at_each_time(tmp_path):
    strips = [[], [np.zeros((2, 3))], [np.ones((3, 3)), np.zeros((2, 3))]]
    shades = np.array([1, 2, 3], dtype=np.uint32)
    found = recorded(tmp_path, lambda r: moving.curves(r, AT, TIMES, strips, shades))
    lengths = [[len(strip) for strip in row] for row in found.rows["LineStrips3D:strips"]]
    assert [row for row in lengths if row is not None][-3:] == [[], [2], [3, 2]]
    assert [row for row in found.rows["LineStrips3D:colors"] if row] == [[1], [2], [3]]


def test_pieces_stand_still_and_change_colours_and_radii(tmp_path):
    pieces = np.arange(12.0).reshape(2, 2, 3)
    colours = np.arange(6, dtype=np.uint32).reshape(3, 2)
    radii = np.arange(6.0).reshape(3, 2)
    found = recorded(
        tmp_path, lambda r: moving.coloured_pieces(r, AT, TIMES, pieces, colours, radii)
    )
    assert np.array(found.static["LineStrips3D:strips"]).tolist() == pieces.tolist()
    assert found.rows["LineStrips3D:colors"] == colours.tolist()
    assert found.rows["LineStrips3D:radii"] == radii.tolist()


def test_points_in_a_plane_may_be_none(tmp_path):
    places = [np.zeros((0, 2)), np.ones((2, 2)), np.zeros((0, 2))]
    found = recorded(tmp_path, lambda r: moving.points_2d(r, AT, TIMES, places, 0xFF00FFFF))
    assert [len(row) for row in found.rows["Points2D:positions"]] == [0, 2, 0]


def test_a_text_changes_with_time(tmp_path):
    places, texts = np.zeros((3, 3)), ["a", "b", "a"]
    found = recorded(tmp_path, lambda r: moving.captions(r, AT, TIMES, places, texts, 0xFF))
    assert found.rows["Points3D:labels"] == [["a"], ["b"], ["a"]]
