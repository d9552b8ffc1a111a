"""``load_gltf``: a glTF 2.0 file to a ``Scene``."""

from __future__ import annotations

from pathlib import Path

from rendergraph.scene.gltf.accessors import Accessors
from rendergraph.scene.gltf.document import Document
from rendergraph.scene.gltf.images import Images
from rendergraph.scene.gltf.items import Item, gltf_error
from rendergraph.scene.gltf.meshes import MeshPool
from rendergraph.scene.gltf.nodes import Hierarchy, read_hierarchy
from rendergraph.scene.gltf.rigs import read_animation, read_skin, rest_transform
from rendergraph.scene.gltf.viewpoints import read_camera, read_light
from rendergraph.scene.scene import Camera, Instance, Light, Scene, Skin, Sun

MAX_INSTANCES = 2**20


def load_gltf(path: Path) -> Scene:
    """Load a .gltf or .glb file's default scene: what is drawn, its materials, lights, cameras, skins and animations.

    Images are measured but not decoded: that happens when their pixels are first asked for. What the file has and the
    scene leaves out is in ``Scene.notes``. World space, metres, radians; lights in candela and lux as they are.

    ``RenderGraphError`` RG601-RG617, naming the file and the JSON path, for anything wrong with the file.
    """
    document = Document(path)
    accessors = Accessors(document)
    images = Images(document)
    hierarchy = read_hierarchy(document)
    skins = [read_skin(item, document, accessors) for item in document.arrays["skins"]]
    pool = MeshPool(document, accessors, images)
    instances = _instances(document, hierarchy, pool, skins)
    cameras, lights, sun = _viewpoints(document, hierarchy)
    return Scene(
        name=path.name,
        **pool.vertex_arrays(),
        meshes=pool.meshes,
        instances=instances,
        materials=pool.materials,
        images=images.images,
        cameras=cameras,
        lights=lights,
        sun=sun,
        nodes=hierarchy.nodes,
        skins=skins,
        animations=[read_animation(item, document, accessors) for item in document.arrays["animations"]],
        notes=document.notes,
    )


def _instances(document: Document, hierarchy: Hierarchy, pool: MeshPool, skins: list[Skin]) -> list[Instance]:
    instances: list[Instance] = []
    for index in hierarchy.visible:
        item = document.arrays["nodes"][index]
        mesh = document.index(item, "mesh", "meshes")
        if mesh is None:
            continue
        name = hierarchy.nodes[index].name or document.arrays["meshes"][mesh].text("name") or f"node {index}"
        skin = document.index(item, "skin", "skins")
        world = hierarchy.worlds[index]
        meshes = pool.use(mesh)
        if skin is not None:  # a skinned mesh is placed by its joints alone
            pool.check_joints(mesh, len(skins[skin].joints))
            world, exact = rest_transform(skins[skin], hierarchy.worlds)
            if not exact:
                document.note(f"{item.path} is skinned and posed; it is drawn in its bind pose")
        instances.extend(Instance(drawn, world, name, skin) for drawn in meshes)
        if len(instances) > MAX_INSTANCES:
            raise gltf_error("RG617", str(item), what="instances", count=len(instances), limit=MAX_INSTANCES)
    return instances


def _viewpoints(document: Document, hierarchy: Hierarchy) -> tuple[list[Camera], list[Light], Sun | None]:
    cameras: list[Camera] = []
    lights: list[Light] = []
    sun: Sun | None = None
    for index in hierarchy.visible:
        item, world = document.arrays["nodes"][index], hierarchy.worlds[index]
        number = document.index(item, "camera", "cameras")
        if number is not None:
            camera = read_camera(document.arrays["cameras"][number], world, hierarchy.nodes[index].name, document)
            cameras.extend([] if camera is None else [camera])
        light = _light(document, item)
        if light is None:
            continue
        placed = read_light(light, world)
        if isinstance(placed, Light):
            lights.append(placed)
        elif sun is None:
            sun = placed
        else:
            document.note(f"{item.path} is a second directional light and was skipped")
    return cameras, lights, sun


def _light(document: Document, node: Item) -> Item | None:
    extension = node.extension("KHR_lights_punctual")
    if extension is None:
        return None
    return document.arrays["lights"][document.as_index(extension.require("light"), "lights")]
