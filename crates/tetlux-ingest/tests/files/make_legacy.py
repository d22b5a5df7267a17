"""Writes the files in vtk_legacy, gmsh and tetgen, with VTK, meshio and Gmsh themselves.

pip install vtk==9.7.2 meshio==5.3.5 gmsh==4.15.2; python make_legacy.py

On every mesh there are the point field f = x + 2 y + 3 z, and the cell field c, the mean x of the cell's points.
"""

from pathlib import Path

import gmsh
import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

HERE = Path(__file__).parent


def fields(points, cells):
    return points @ [1.0, 2.0, 3.0], np.array([points[list(cell), 0].mean() for cell in cells])


def write_vtk(data, name):
    points = np.array([data.GetPoint(i) for i in range(data.GetNumberOfPoints())])
    ids = lambda c: data.GetCell(c).GetPointIds()
    cells = [[ids(c).GetId(i) for i in range(ids(c).GetNumberOfIds())] for c in range(data.GetNumberOfCells())]
    for place, key, values in zip((data.GetPointData(), data.GetCellData()), "fc", fields(points, cells)):
        array = numpy_to_vtk(values, deep=1)
        array.SetName(key)
        place.SetScalars(array)
    for version in (42, 51):
        for binary in (False, True):
            writer = vtk.vtkDataSetWriter()
            writer.SetFileName(str(HERE / "vtk_legacy" / f"{name}_{version}_{'binary' if binary else 'ascii'}.vtk"))
            writer.SetInputData(data)
            writer.SetFileVersion(version)
            writer.SetFileType(vtk.VTK_BINARY if binary else vtk.VTK_ASCII)
            writer.Write()


def vtk_points(points):
    result = vtk.vtkPoints()
    result.SetDataType(vtk.VTK_DOUBLE)
    for p in points:
        result.InsertNextPoint(p)
    return result


def vtk_files():
    """A polyhedral cube below a pyramid, and beside them a voxel, a hexahedron, a wedge and a tetrahedron."""
    cube = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    points = [*cube, (0.5, 0.5, 2)]
    for i in range(4):
        points += [(x + 3 * i + 3, y, z) for x, y, z in cube]
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(vtk_points(points))
    faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    stream = vtk.vtkIdList()
    for v in [len(faces), *(v for face in faces for v in [len(face), *face])]:
        stream.InsertNextId(v)
    grid.InsertNextCell(42, stream)
    grid.InsertNextCell(14, 5, [4, 5, 6, 7, 8])
    kinds = [(11, [0, 1, 3, 2, 4, 5, 7, 6]), (12, range(8)), (13, [0, 3, 1, 4, 7, 5]), (10, [0, 1, 3, 4])]
    for i, (kind, corners) in enumerate(kinds):
        grid.InsertNextCell(kind, len(corners), [9 + 8 * i + v for v in corners])
    write_vtk(grid, "cells")
    image = vtk.vtkImageData()
    image.SetDimensions(4, 3, 2)
    image.SetSpacing(0.5, 1, 2)
    image.SetOrigin(1, 2, 3)
    write_vtk(image, "image")
    rectilinear = vtk.vtkRectilinearGrid()
    rectilinear.SetDimensions(4, 3, 2)
    for put, values in (("X", [0, 1, 1.5, 4]), ("Y", [0, 1, 3]), ("Z", [-1, 1])):
        getattr(rectilinear, f"Set{put}Coordinates")(numpy_to_vtk(np.array(values, float), deep=1))
    write_vtk(rectilinear, "rectilinear")
    structured = vtk.vtkStructuredGrid()
    structured.SetDimensions(4, 3, 2)
    structured.SetPoints(vtk_points([(i + 0.25 * j, j, k) for k in range(2) for j in range(3) for i in range(4)]))
    write_vtk(structured, "structured")


def meshio_files():
    """Two hexahedra and on them two pyramids; and two tetrahedra."""
    points = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)] + [(0.5, 0.5, 2), (1.5, 0.5, 2)], float)
    hexahedra = np.array([[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]])
    pyramids = np.array([[6, 7, 10, 9, 12], [7, 8, 11, 10, 13]])
    f, c = fields(points, [*hexahedra, *pyramids])
    mixed = meshio.Mesh(points, [("hexahedron", hexahedra), ("pyramid", pyramids)], {"f": f}, {"c": [c[:2], c[2:]]})
    for binary in (False, True):
        name = f"meshio_42_{'binary' if binary else 'ascii'}.vtk"
        meshio.write(HERE / "vtk_legacy" / name, mixed, file_format="vtk42", binary=binary)
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)], float)
    tetrahedra = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
    f, c = fields(corners, tetrahedra)
    mesh = meshio.Mesh(corners, [("tetra", tetrahedra)], {"f": f}, {"c": [c]})
    # To version 4.1 meshio writes one type of cell.
    for kind, version, what in (("gmsh22", 22, mixed), ("gmsh", 41, mesh)):
        # In words meshio writes values as "np.float64(0.0)" where NumPy is of version 2.
        meshio.write(HERE / "gmsh" / f"meshio_{version}_binary.msh", what, file_format=kind, binary=True)
    meshio.write(HERE / "tetgen" / "meshio.node", mesh, float_fmt=".17g")


def gmsh_mesh(kind):
    """A unit cube, or a pyramid on the unit square with apex at height 1, its tags sparse."""
    gmsh.clear()
    gmsh.model.add("m")
    if kind == "pyramid":
        gmsh.model.addDiscreteEntity(3, 1)
        gmsh.model.mesh.addNodes(3, 1, [10, 20, 35, 40, 57], [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5, 0.5, 1])
        gmsh.model.mesh.addElementsByType(1, 7, [100], [10, 20, 35, 40, 57])
        return
    if kind == "tetrahedra":
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.synchronize()
    else:
        geo = gmsh.model.geo
        line = geo.extrude([(0, geo.addPoint(0, 0, 0))], 1, 0, 0, numElements=[1])
        square = geo.extrude([line[1]], 0, 1, 0, numElements=[1], recombine=kind == "hexahedra")
        geo.extrude([square[1]], 0, 0, 1, numElements=[1], recombine=True)
        geo.synchronize()
    gmsh.model.addPhysicalGroup(3, [tag for _, tag in gmsh.model.getEntities(3)], name="my volume")
    gmsh.model.mesh.generate(3)


def gmsh_files():
    gmsh.initialize()
    for key, value in (("General.Terminal", 0), ("Mesh.MeshSizeMin", 2), ("Mesh.MeshSizeMax", 2), ("Mesh.SaveAll", 1)):
        gmsh.option.setNumber(key, value)
    for kind in ("tetrahedra", "hexahedra", "prisms", "pyramid"):
        for order, incomplete in ((1, 0), (2, 0), (2, 1)):
            for version in (2.2, 4.1):
                for binary in (0, 1):
                    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
                    gmsh_mesh(kind)
                    gmsh.model.mesh.setOrder(order)
                    gmsh.option.setNumber("Mesh.MshFileVersion", version)
                    gmsh.option.setNumber("Mesh.Binary", binary)
                    tags, places, _ = gmsh.model.mesh.getNodes()
                    place = dict(zip(tags, places.reshape(-1, 3)))
                    f = [place[t] @ [1.0, 2.0, 3.0] for t in tags]
                    [element], [ids], [nodes] = gmsh.model.mesh.getElements(3)
                    c = [np.mean([place[t][0] for t in e]) for e in nodes.reshape(len(ids), -1)]
                    for view in gmsh.view.getTags():
                        gmsh.view.remove(view)
                    suffix = "serendipity" if incomplete else order
                    name = f"{kind}_{suffix}_{int(version * 10)}_{'binary' if binary else 'ascii'}.msh"
                    if order == 2 and (version, binary) not in ((2.2, 0), (4.1, 1)) or incomplete and kind == "tetrahedra":
                        continue
                    for i, (data, where, at, values) in enumerate((("f", "NodeData", tags, f), ("c", "ElementData", ids, c))):
                        view = gmsh.view.add(data)
                        gmsh.view.addHomogeneousModelData(view, 0, "m", where, at, values)
                        # Gmsh writes the mesh with each view, or with the first alone.
                        gmsh.option.setNumber("PostProcessing.SaveMesh", int(i == 0 or order == 1))
                        gmsh.view.write(view, str(HERE / "gmsh" / name), append=i > 0)
    gmsh.finalize()


for folder in ("vtk_legacy", "gmsh", "tetgen"):
    (HERE / folder).mkdir(exist_ok=True)
vtk_files()
meshio_files()
gmsh_files()
