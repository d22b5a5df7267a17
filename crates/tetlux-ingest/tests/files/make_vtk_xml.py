"""Writes the files in vtk_xml/ with VTK (pip install vtk): python make_vtk_xml.py [FOLDER [--all]].

With --all every combination of layout, compressor, header type and byte order is written, not the few that are kept.
"""

import itertools
import math
import os
import sys

import vtk
from vtk.util.numpy_support import numpy_to_vtk
import numpy as np

folder = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "vtk_xml")
everything = "--all" in sys.argv
os.makedirs(folder, exist_ok=True)
os.chdir(folder)

LAYOUTS = ["ascii", "base64", "appended64", "raw"]
COMPRESSORS = ["none", "zlib", "lz4", "lzma"]


def write(writer, name, data, layout="raw", compressor="none", header=32, big=False):
    writer.SetFileName(name)
    if data is not None:
        writer.SetInputDataObject(data)
    if layout == "ascii":
        writer.SetDataModeToAscii()
    elif layout == "base64":
        writer.SetDataModeToBinary()
    else:
        writer.SetDataModeToAppended()
        writer.SetEncodeAppendedData(layout == "appended64")
    writer.SetCompressorType(COMPRESSORS.index(compressor))
    if COMPRESSORS.index(compressor) and not everything:
        writer.SetBlockSize(1024)
    writer.SetHeaderTypeToUInt64() if header == 64 else writer.SetHeaderTypeToUInt32()
    writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
    assert writer.Write() == 1, name


def matrix(make, stem, extension, data, few):
    """All combinations, or these few: pairs in which every value of every option meets each compressor."""
    combinations = itertools.product(LAYOUTS, COMPRESSORS, [32, 64], [False, True]) if everything else few
    for layout, compressor, header, big in combinations:
        name = f"{stem}-{layout}-{compressor}-{header}-{'big' if big else 'little'}.{extension}"
        write(make(), name, data, layout, compressor, header, big)


def add_fields(data, points):
    """On points f = x + 2 y - z and the position, on cells their number."""
    f = numpy_to_vtk(points @ np.array([1.0, 2.0, -1.0]), deep=True)
    f.SetName("f")
    data.GetPointData().AddArray(f)
    position = numpy_to_vtk(points.astype(np.float32), deep=True)
    position.SetName("position")
    data.GetPointData().AddArray(position)
    number = numpy_to_vtk(np.arange(data.GetNumberOfCells(), dtype=np.int16), deep=True)
    number.SetName("number")
    data.GetCellData().AddArray(number)


def unstructured(shapes):
    """Cells side by side, three apart along x; a shape is a type and its points, or the faces of a polyhedron."""
    grid, points, coordinates = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), []
    points.SetDataTypeToDouble()
    for c, (kind, corners, faces) in enumerate(shapes):
        first = len(coordinates)
        for x, y, z in corners:
            coordinates.append([x + 3.0 * c, y, z])
            points.InsertNextPoint(coordinates[-1])
        if faces:
            ids = vtk.vtkIdList()
            ids.InsertNextId(len(faces))
            for face in faces:
                ids.InsertNextId(len(face))
                for v in face:
                    ids.InsertNextId(first + v)
            grid.InsertNextCell(kind, ids)
        else:
            grid.InsertNextCell(kind, len(corners), range(first, first + len(corners)))
    grid.SetPoints(points)
    add_fields(grid, np.array(coordinates))
    return grid


CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
FACES = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
PRISM = [[0, 0, 0], [0, 1, 0], [1, 0, 0], [0, 0, 1], [0, 1, 1], [1, 0, 1]]
LINEAR = [
    (10, [CUBE[0], CUBE[1], CUBE[3], CUBE[4]], None),
    (11, [CUBE[i] for i in [0, 1, 3, 2, 4, 5, 7, 6]], None),
    (42, CUBE, FACES),
    (12, CUBE, None),
    (13, PRISM, None),
    (14, CUBE[:4] + [CUBE[4]], None),
    (42, PRISM, [[0, 1, 2], [3, 5, 4], [0, 3, 4, 1], [1, 4, 5, 2], [2, 5, 3, 0]]),
]


def quadratic(kind, make):
    cell = make()
    p = cell.GetParametricCoords()
    return kind, [[p[3 * i], p[3 * i + 1], p[3 * i + 2]] for i in range(cell.GetNumberOfPoints())], None


QUADRATIC = [
    quadratic(24, vtk.vtkQuadraticTetra),
    quadratic(25, vtk.vtkQuadraticHexahedron),
    quadratic(26, vtk.vtkQuadraticWedge),
    quadratic(27, vtk.vtkQuadraticPyramid),
    quadratic(29, vtk.vtkTriQuadraticHexahedron),
]

cells = unstructured(LINEAR)
FEW = [
    ("ascii", "none", 32, False),
    ("ascii", "lzma", 64, True),
    ("base64", "none", 64, True),
    ("base64", "zlib", 32, False),
    ("base64", "lz4", 64, False),
    ("base64", "lzma", 32, True),
    ("appended64", "none", 32, False),
    ("appended64", "zlib", 64, True),
    ("appended64", "lz4", 32, True),
    ("appended64", "lzma", 64, False),
    ("raw", "none", 64, False),
    ("raw", "zlib", 64, False),
    ("raw", "lz4", 64, True),
    ("raw", "lzma", 32, False),
    ("raw", "zlib", 32, True),
]
matrix(vtk.vtkXMLUnstructuredGridWriter, "cells", "vtu", cells, FEW)
write(vtk.vtkXMLUnstructuredGridWriter(), "quadratic.vtu", unstructured(QUADRATIC), "raw", "zlib")

# A lattice of 4 x 3 x 3 points, first index 2, -1, 0.
EXTENT = [2, 5, -1, 1, 0, 2]
index = np.array([[i, j, k] for k in range(3) for j in range(-1, 2) for i in range(2, 6)], float)


def structured(places):
    grid, points = vtk.vtkStructuredGrid(), vtk.vtkPoints()
    points.SetData(numpy_to_vtk(places, deep=True))
    grid.SetExtent(EXTENT)
    grid.SetPoints(points)
    add_fields(grid, places)
    return grid


places = np.stack([index[:, 0], 2 * index[:, 1], 3 * index[:, 2] + 0.25 * index[:, 0]], 1)
HALF = FEW[::2]
matrix(vtk.vtkXMLStructuredGridWriter, "curved", "vts", structured(places), HALF)
blanked = structured(places)
blanked.BlankCell(0)
blanked.BlankPoint(35)
write(vtk.vtkXMLStructuredGridWriter(), "blanked.vts", blanked, "ascii")
blanked = structured(places)
blanked.BlankPoint(35)
write(vtk.vtkXMLStructuredGridWriter(), "blanked-point.vts", blanked, "raw", "zlib", 64)

rectilinear = vtk.vtkRectilinearGrid()
rectilinear.SetExtent(EXTENT)
axes = [[0.0, 1.0, 3.0, 4.5], [-1.0, 0.0, 2.0], [0.0, 0.5, 4.0]]
for axis, values in zip("XYZ", axes):
    getattr(rectilinear, f"Set{axis}Coordinates")(numpy_to_vtk(np.array(values), deep=True))
add_fields(rectilinear, np.array([[x, y, z] for z in axes[2] for y in axes[1] for x in axes[0]]))
matrix(vtk.vtkXMLRectilinearGridWriter, "axes", "vtr", rectilinear, HALF)

image = vtk.vtkImageData()
image.SetExtent(EXTENT)
image.SetOrigin(10, 20, 30)
image.SetSpacing(0.5, 1, 2)
image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
turned = np.stack([10 - index[:, 1], 20 + 0.5 * index[:, 0], 30 + 2 * index[:, 2]], 1)
add_fields(image, turned)
matrix(vtk.vtkXMLImageDataWriter, "image", "vti", image, HALF)

# Files of pieces, with ghosts, of a source that works in pieces; and the same in one.
source = vtk.vtkRTAnalyticSource()
source.SetWholeExtent(-2, 2, -1, 1, -1, 1)
threshold = vtk.vtkThreshold()
threshold.SetInputConnection(source.GetOutputPort())
threshold.SetThresholdFunction(vtk.vtkThreshold.THRESHOLD_LOWER)
threshold.SetLowerThreshold(1e9)
curve = vtk.vtkImageDataToPointSet() if hasattr(vtk, "vtkImageDataToPointSet") else vtk.vtkImageToStructuredGrid()
curve.SetInputConnection(source.GetOutputPort())
for stem, extension, filter, serial, parallel in [
    ("wave-image", "vti", source, vtk.vtkXMLImageDataWriter, vtk.vtkXMLPImageDataWriter),
    ("wave-curved", "vts", curve, vtk.vtkXMLStructuredGridWriter, vtk.vtkXMLPStructuredGridWriter),
    ("wave-cells", "vtu", threshold, vtk.vtkXMLUnstructuredGridWriter, vtk.vtkXMLPUnstructuredGridWriter),
]:
    writer = serial()
    writer.SetInputConnection(filter.GetOutputPort())
    write(writer, f"{stem}.{extension}", None, "raw", "zlib")
    for ghosts in [0, 1]:
        writer = parallel()
        writer.SetInputConnection(filter.GetOutputPort())
        writer.SetNumberOfPieces(3)
        writer.SetStartPiece(0)
        writer.SetEndPiece(2)
        writer.SetGhostLevel(ghosts)
        write(writer, f"{stem}-ghosts-{ghosts}.p{extension}", None, "raw", "zlib")

blocks = vtk.vtkMultiBlockDataSet()
inner = vtk.vtkMultiBlockDataSet()
sphere = vtk.vtkSphereSource()
sphere.SetThetaResolution(3)
sphere.SetPhiResolution(3)
sphere.Update()
inner.SetBlock(0, rectilinear)
inner.SetBlock(1, sphere.GetOutput())
blocks.SetBlock(0, cells)
blocks.SetBlock(1, None)
blocks.SetBlock(2, inner)
write(vtk.vtkXMLMultiBlockDataWriter(), "blocks.vtm", blocks, "raw", "zlib")

# Three time steps in one file: what stays is written once.
times = unstructured(LINEAR[:2])
writer = vtk.vtkXMLUnstructuredGridWriter()
writer.SetFileName("times.vtu")
writer.SetInputData(times)
writer.SetNumberOfTimeSteps(3)
writer.SetDataModeToAppended()
writer.SetEncodeAppendedData(True)
writer.Start()
for step in range(3):
    number = numpy_to_vtk(np.arange(2, dtype=np.int16) + 10 * step, deep=True)
    number.SetName("number")
    times.GetCellData().AddArray(number)
    times.Modified()
    writer.WriteNextTime(math.pi * step)
writer.Stop()

for path, _, files in os.walk("."):
    for name in files:
        size = os.path.getsize(os.path.join(path, name))
        assert everything or size < 10240, (name, size)
