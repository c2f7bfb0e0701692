"""Shows that Blender loads and renders a volume that pse baked: prints its grids and writes a picture.

usage: blender --background --python scripts/blender_volume.py -- cloud.vdb picture.png [SIZE] [SAMPLES]

The grid `density` scatters light, `color` tints it, `temperature` (kelvin) makes it glow. Exits with 1 where a grid is missing
or the picture is empty. For hand checks and the gallery; tests skip it where there is no Blender.
"""

import math
import sys

import bpy


def look_at(thing, place, target):
    """Puts a camera or light at `place`, turned to `target`."""
    from mathutils import Vector

    thing.location = place
    thing.rotation_euler = (Vector(target) - Vector(place)).to_track_quat("-Z", "Y").to_euler()


def main():
    file, picture, *rest = sys.argv[sys.argv.index("--") + 1:]
    size, samples = [int(word) for word in rest] + [512, 64][len(rest):]
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)

    # The volume. pse's files have y up and Blender z.
    bpy.ops.object.volume_import(filepath=file)
    volume = bpy.context.object
    volume.rotation_euler = (math.pi / 2, 0, 0)
    volume.data.grids.load()
    names = [grid.name for grid in volume.data.grids]
    print("grids:", " ".join(f"{grid.name}:{grid.data_type}" for grid in volume.data.grids))
    if "density" not in names:
        print("there is no grid density", file=sys.stderr)
        return 1

    # What it is made of.
    material = bpy.data.materials.new("matter")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    matter = nodes.new("ShaderNodeVolumePrincipled")
    matter.inputs["Density"].default_value = 26
    matter.inputs["Anisotropy"].default_value = 0.2
    matter.inputs["Color"].default_value = (0.92, 0.93, 0.95, 1)
    if "color" in names:
        matter.inputs["Color Attribute"].default_value = "color"
        matter.inputs["Color"].default_value = (1, 1, 1, 1)
    if "temperature" in names:
        matter.inputs["Temperature Attribute"].default_value = "temperature"
        matter.inputs["Blackbody Intensity"].default_value = 0.6
    links.new(matter.outputs["Volume"], nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    volume.data.materials.append(material)

    # Evening light from the left, sky behind.
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.color, sun.data.angle = 12, (1, 0.78, 0.56), 0.05
    look_at(sun, (-4, -2.5, 2.2), (0, 0, 0))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.lens = 88
    look_at(camera, (0, -5, 0.3), (0, 0, 0.03))
    for thing in (sun, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    world = scene.world or bpy.data.worlds.new("world")
    scene.world = world
    world.use_nodes = True
    background = world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.16, 0.26, 0.45, 1)
    background.inputs["Strength"].default_value = 0.55

    # The picture.
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.volume_bounces = 8
    scene.cycles.volume_step_rate = 2
    scene.cycles.sample_clamp_indirect = 2
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.filepath = picture
    scene.render.image_settings.file_format = "PNG"
    scene.view_settings.view_transform = "Filmic"
    scene.view_settings.look = "Medium High Contrast"
    bpy.ops.render.render(write_still=True)

    # What it shows differs from the sky alone.
    pixels = list(bpy.data.images.load(picture).pixels)
    red = pixels[0::4]
    contrast = max(red) - min(red)
    print(f"contrast: {contrast:.3f}")
    return 0 if contrast > 0.1 else 1


sys.exit(main())
