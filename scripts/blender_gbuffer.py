"""Renders the G-buffer of a mesh with Blender: an EXR of position, normal, UV, depth and index that pse shades.

usage: blender --background --python scripts/blender_gbuffer.py -- MESH.obj OUT.exr [--res N] [--turn DEGREES] [--away METRES]

The mesh is fitted as `pse render --on` fits it: centred, its longest side 2. Blender's z points up, pse's y does: the
mesh is loaded so that Blender's X, Y and Z are the file's own, and the camera looks at it from +z with y up. So
Position and Normal are in the frame in which the same program runs with --on. Written for Blender 3.4, and for the
names of its passes: ViewLayer.Position.X, ViewLayer.Normal.X, ViewLayer.UV.U, ViewLayer.Depth.Z, ViewLayer.IndexOB.X.
"""

import argparse
import math
import pathlib
import sys

import bpy
import mathutils


def arguments():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(prog="blender_gbuffer.py")
    parser.add_argument("mesh", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--res", type=int, default=1024)
    parser.add_argument("--turn", type=float, default=0, help="of the camera around the mesh, in degrees")
    parser.add_argument("--away", type=float, default=4.3, help="the camera's distance from the mesh's middle")
    options = parser.parse_args(words)
    if not options.mesh.exists():
        parser.error(f"there is no {options.mesh}")
    print("eye for --camera:", ",".join(f"{options.away * c:.4g}" for c in
                                        (math.sin(math.radians(options.turn)), 0.22,
                                         math.cos(math.radians(options.turn)))))
    return options


def load(path):
    """The mesh with the coordinates of its file, fitted."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.obj_import(filepath=str(path.resolve()), forward_axis="Y", up_axis="Z")
    objects = [o for o in bpy.context.scene.objects if o.type == "MESH"]
    corners = [o.matrix_world @ mathutils.Vector(c) for o in objects for c in o.bound_box]
    low = mathutils.Vector([min(c[a] for c in corners) for a in range(3)])
    high = mathutils.Vector([max(c[a] for c in corners) for a in range(3)])
    scale = 2 / max(high - low)
    fit = mathutils.Matrix.Scale(scale, 4) @ mathutils.Matrix.Translation(-(low + high) / 2)
    for index, o in enumerate(objects):
        o.matrix_world = fit @ o.matrix_world
        o.pass_index = index + 1
        for polygon in o.data.polygons:
            polygon.use_smooth = True


def look(options):
    """A camera in front of the mesh, a little above, y up."""
    scene = bpy.context.scene
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.lens = 60
    scene.collection.objects.link(camera)
    scene.camera = camera
    angle = math.radians(options.turn)
    eye = options.away * mathutils.Vector((math.sin(angle), 0.22, math.cos(angle)))
    back = eye.normalized()
    right = mathutils.Vector((0, 1, 0)).cross(back).normalized()
    axes = mathutils.Matrix((right, back.cross(right), back)).transposed()
    camera.matrix_world = mathutils.Matrix.Translation(eye) @ axes.to_4x4()


def render(options):
    """One sample without a pixel filter: what a G-buffer holds must not be mixed across edges."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 1
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 0.01
    scene.render.resolution_x = scene.render.resolution_y = options.res
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = True
    layer = scene.view_layers[0]
    layer.name = "ViewLayer"
    for name in ("use_pass_position", "use_pass_normal", "use_pass_uv", "use_pass_z", "use_pass_object_index"):
        setattr(layer, name, True)
    settings = scene.render.image_settings
    settings.file_format = "OPEN_EXR_MULTILAYER"
    settings.color_depth = "32"
    settings.exr_codec = "ZIP"
    scene.render.filepath = str(options.out.resolve())
    scene.render.use_file_extension = False
    bpy.ops.render.render(write_still=True)


options = arguments()
load(options.mesh)
look(options)
render(options)
