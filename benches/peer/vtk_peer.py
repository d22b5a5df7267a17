#!/usr/bin/env python3
"""The same scene by VTK's renderers of unstructured meshes: pictures, times, memory.

    pip install vtk
    python vtk_peer.py target/bench/peer/wing/job.json            # every renderer once, as a table
    python vtk_peer.py JOB.json --only pt bunyk-partial --frames 5 --output pictures
    python vtk_peer.py JOB.json --serve                           # as `cargo xtask bench --peer vtk` calls it

`cargo xtask bench --peer vtk` writes the job: a mesh (legacy VTK), a transfer function, a camera. Pictures are PPM files of
what VTK composited over the background, without gamma. Times are of one whole frame from a view that differs from the one
before by a thousandth of a degree, as wall seconds and as processor seconds of all threads, user and system.
"""

import argparse
import json
import os
import resource
import sys
import time

try:
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    sys.exit(f"VTK for Python is missing ({error}): pip install vtk")

RENDERERS = {
    "pt": "projected tetrahedra",
    "bunyk-partial": "Bunyk ray cast, partial pre-integration",
    "bunyk-linear": "Bunyk ray cast, linear",
    "bunyk-homogeneous": "Bunyk ray cast, homogeneous",
    "bunyk-preintegration": "Bunyk ray cast, pre-integration",
    "zsweep-partial": "Z sweep, partial pre-integration",
}
INTEGRATORS = {
    "partial": "vtkUnstructuredGridPartialPreIntegration",
    "linear": "vtkUnstructuredGridLinearRayIntegrator",
    "homogeneous": "vtkUnstructuredGridHomogeneousRayIntegrator",
    "preintegration": "vtkUnstructuredGridPreIntegration",
}


def mapper_of(name):
    """The mapper of a renderer's name; a full picture each, without samples left out."""
    if name == "pt":
        return vtk.vtkProjectedTetrahedraMapper()
    way, integrator = name.split("-")
    if way == "bunyk":
        mapper = vtk.vtkUnstructuredGridVolumeRayCastMapper()
        mapper.SetRayCastFunction(vtk.vtkUnstructuredGridBunykRayCastFunction())
    else:
        mapper = vtk.vtkUnstructuredGridVolumeZSweepMapper()
    mapper.SetAutoAdjustSampleDistances(0)
    mapper.SetImageSampleDistance(1.0)
    mapper.SetRayIntegrator(getattr(vtk, INTEGRATORS[integrator])())
    return mapper


class Scene:
    """A job, its mesh read, in a window that is not shown."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            job = json.load(file)
        reader = vtk.vtkUnstructuredGridReader()
        reader.SetFileName(os.path.join(os.path.dirname(path), job["mesh"]))
        reader.Update()
        self.mesh = reader.GetOutput()
        if self.mesh.GetNumberOfCells() == 0:
            sys.exit(f"{reader.GetFileName()}: no cells could be read")
        self.mesh.GetPointData().SetActiveScalars(job["field"])

        color = vtk.vtkColorTransferFunction()
        color.SetColorSpaceToRGB()
        for s, red, green, blue in job["color"]:
            color.AddRGBPoint(s, red, green, blue)
        opacity = vtk.vtkPiecewiseFunction()
        for s, value in job["opacity"]:
            opacity.AddPoint(s, value)
        look = vtk.vtkVolumeProperty()
        look.SetColor(color)
        look.SetScalarOpacity(opacity)
        look.SetScalarOpacityUnitDistance(job["unit_distance"])
        look.SetInterpolationTypeToLinear()
        look.ShadeOff()

        self.volume = vtk.vtkVolume()
        self.volume.SetProperty(look)
        self.renderer = vtk.vtkRenderer()
        self.renderer.SetBackground(*job["background"])
        self.renderer.AddVolume(self.volume)
        self.window = vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*job["size"])
        self.window.AddRenderer(self.renderer)

        self.camera = job["camera"]
        self.mappers = {}

    def aim(self, turn):
        """The scene's camera, turned round the focal point by some degrees."""
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(*self.camera["position"])
        camera.SetFocalPoint(*self.camera["focal_point"])
        camera.SetViewUp(*self.camera["view_up"])
        if "parallel_scale" in self.camera:
            camera.ParallelProjectionOn()
            camera.SetParallelScale(self.camera["parallel_scale"])
        else:
            camera.SetViewAngle(self.camera["view_angle"])
        camera.Azimuth(turn)
        self.renderer.ResetCameraClippingRange()

    def frame(self, name, turn, picture):
        """Draws a frame, keeps its picture if a file is named, and gives what it took."""
        if name not in self.mappers:
            self.mappers[name] = mapper_of(name)
            self.mappers[name].SetInputData(self.mesh)
        self.volume.SetMapper(self.mappers[name])
        self.aim(turn)
        forget_peak()
        wall, cpu = time.perf_counter(), time.process_time()
        self.window.Render()
        # Done when its pixels can be read.
        self.window.WaitForCompletion()
        took = {
            "wall_seconds": time.perf_counter() - wall,
            "cpu_seconds": time.process_time() - cpu,
            "peak_bytes": peak(),
        }
        if picture:
            self.write(picture)
        return took

    def write(self, path):
        """The picture as it is composited, top row first."""
        grab = vtk.vtkWindowToImageFilter()
        grab.SetInput(self.window)
        grab.SetInputBufferTypeToRGB()
        grab.ReadFrontBufferOff()
        grab.ShouldRerenderOff()
        grab.Update()
        image = grab.GetOutput()
        width, height, _ = image.GetDimensions()
        rows = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3)[::-1]
        with open(path, "wb") as file:
            file.write(f"P6\n{width} {height}\n255\n".encode())
            file.write(rows.tobytes())

    def machine(self):
        """The version of VTK, and what draws its triangles."""
        self.window.Render()
        capabilities = self.window.ReportCapabilities().splitlines()
        lines = [line.split(":", 1)[1].strip() for line in capabilities if "renderer string" in line]
        return {"version": vtk.vtkVersion.GetVTKVersion(), "opengl": lines[0] if lines else "unknown"}


def forget_peak():
    """Lets the peak of resident memory begin anew, where the system can."""
    try:
        with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
            file.write("5")
    except OSError:
        pass


def peak():
    """The most bytes that were resident."""
    try:
        with open("/proc/self/status", encoding="ascii") as file:
            for line in file:
                if line.startswith("VmHWM:"):
                    return int(line.split()[1]) * 1024
    except OSError:
        pass
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


def serve(scene):
    """Answers lines "RENDERER TURN [PICTURE]", tabs between, with a line of JSON each, until the input ends."""
    print(json.dumps(scene.machine()), flush=True)
    for line in sys.stdin:
        name, turn, *picture = line.rstrip("\n").split("\t")
        print(json.dumps(scene.frame(name, float(turn), picture[0] if picture else None)), flush=True)


def table(scene, names, frames, folder):
    """Draws by each renderer and prints the medians."""
    os.makedirs(folder, exist_ok=True)
    machine = scene.machine()
    print(f"VTK {machine['version']}, {machine['opengl']}; {scene.mesh.GetNumberOfCells()} cells")
    print(f"{'renderer':<42} {'wall s':>8} {'CPU s':>8} {'peak MiB':>9}")
    for name in names:
        scene.frame(name, 0.0, os.path.join(folder, f"{name}.ppm"))
        took = [scene.frame(name, 1e-3 * (k + 1), None) for k in range(frames)]
        wall, cpu, most = (sorted(t[key] for t in took)[len(took) // 2] for key in took[0])
        print(f"{RENDERERS[name]:<42} {wall:>8.3f} {cpu:>8.3f} {most / 2**20:>9.0f}", flush=True)


def main():
    """Reads the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )
    parser.add_argument("job", help="job.json as `cargo xtask bench --peer vtk` writes it")
    parser.add_argument("--only", nargs="+", choices=RENDERERS, default=["pt", "bunyk-partial", "bunyk-linear"])
    parser.add_argument("--frames", type=int, default=3, help="timed frames of each, after one that is not timed")
    parser.add_argument("--output", default="out", help="folder for the pictures")
    parser.add_argument("--serve", action="store_true", help="draw what lines on standard input ask for")
    arguments = parser.parse_args()
    vtk.vtkObject.GlobalWarningDisplayOff()
    scene = Scene(arguments.job)
    if arguments.serve:
        serve(scene)
    else:
        table(scene, arguments.only, max(arguments.frames, 1), arguments.output)


if __name__ == "__main__":
    main()
