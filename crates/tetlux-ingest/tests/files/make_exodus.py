"""Writes exodus/*.e with meshio, and the netCDF library for the classic formats: python make_exodus.py

Needs meshio, netCDF4 and numpy.
"""

import tempfile
from pathlib import Path

import meshio
import netCDF4
import numpy as np

CUBE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
TETRA = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
CELLS = [
    ("hexahedron", [CUBE, CUBE]),
    ("wedge", [[CUBE[i] for i in (0, 1, 3, 4, 5, 7)]]),
    ("pyramid", [[CUBE[i] for i in (0, 1, 2, 3, 4)]]),
    ("tetra", [TETRA]),
    ("tetra10", [TETRA + [np.mean([TETRA[i], TETRA[j]], 0) for i, j in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]]),
]


def mesh():
    """Cells apart from one another, with a linear function on their points."""
    points, blocks = [], []
    for kind, cells in CELLS:
        block = []
        for cell in cells:
            block.append(range(len(points), len(points) + len(cell)))
            shift = 4.0 * len(blocks) + 2.0 * len(block)
            points += [np.asarray(p, float) + [shift, 0, 0] for p in cell]
        blocks.append((kind, np.array(block)))
    points = np.array(points)
    return meshio.Mesh(points, blocks, point_data={"sum": points @ [1.0, 2.0, 4.0]})


def convert(source, target, file_format):
    """Copies a netCDF file into another of its formats."""
    with netCDF4.Dataset(source) as a, netCDF4.Dataset(target, "w", format=file_format) as b:
        a.set_auto_maskandscale(False)
        a.set_auto_chartostring(False)
        b.setncatts({name: a.getncattr(name) for name in a.ncattrs() if not name.startswith("_")})
        for name, dimension in a.dimensions.items():
            # The classic formats take length 0 for an unlimited dimension, and have only one.
            if name == "time_step" or dimension.size > 0:
                b.createDimension(name, None if name == "time_step" else dimension.size)
        for name, variable in a.variables.items():
            # The classic formats have no 64-bit integers but in CDF-5.
            kind = "i4" if variable.dtype == np.int64 and file_format != "NETCDF3_64BIT_DATA" else variable.dtype
            copy = b.createVariable(name, kind, variable.dimensions)
            copy.set_auto_maskandscale(False)
            copy.set_auto_chartostring(False)
            copy.setncatts({k: variable.getncattr(k) for k in variable.ncattrs() if k != "_FillValue"})
            copy[:] = variable[:]


folder = Path(__file__).parent / "exodus"
folder.mkdir(exist_ok=True)
with tempfile.TemporaryDirectory() as temporary:
    original = Path(temporary) / "mesh.e"
    mesh().write(original)
    for suffix in ("CLASSIC", "64BIT_OFFSET", "64BIT_DATA"):
        convert(original, folder / f"{suffix.lower()}.e", f"NETCDF3_{suffix}")

# In HDF5, small as its overhead allows: a cube at two times, of which one array is compressed and shuffled.
with netCDF4.Dataset(folder / "netcdf4.e", "w", format="NETCDF4") as file:
    for name, size in {"len_name": 33, "time_step": 2, "num_dim": 3, "num_nodes": 8, "num_el_in_blk1": 1,
                       "num_nod_per_el1": 8, "num_nod_var": 1}.items():
        file.createDimension(name, size)
    for axis, values in zip("xyz", np.array(CUBE, float).T):
        file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values
    cells = file.createVariable("connect1", "i4", ("num_el_in_blk1", "num_nod_per_el1"))
    cells.elem_type = "HEX8"
    cells[:] = np.arange(1, 9)
    names = file.createVariable("name_nod_var", "S1", ("num_nod_var", "len_name"))
    names[0, :3] = list("sum")
    file.createVariable("time_whole", "f8", ("time_step",))[:] = [0.5, 1.5]
    values = file.createVariable("vals_nod_var1", "f4", ("time_step", "num_nodes"), zlib=True, chunksizes=(1, 8))
    values[:] = np.outer([1, 2], np.array(CUBE) @ [1, 2, 4])
