"""What a linked program declares, read through the program interface queries (GL 4.5, 7.3.1)."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Final

from rendergraph.device import enums as e
from rendergraph.device.gl import GL


@dataclass(frozen=True, slots=True)
class Uniform:
    """A uniform outside blocks: GLSL type, location, array length; components and scalar kind of one element."""

    type: str
    location: int
    count: int

    @property
    def scalar(self) -> str:
        """``float``, ``int``, ``uint`` or ``bool``."""
        if self.type.startswith(("vec", "mat", "float")):
            return "float"
        return {"u": "uint", "b": "bool", "i": "int"}[self.type[0]]

    @property
    def components(self) -> int:
        """Scalars in one element: 1 to 4, or 4, 9, 16 for matrices."""
        if not self.type[-1].isdigit():
            return 1
        size = int(self.type[-1])
        return size * size if self.type.startswith("mat") else size


@dataclass(frozen=True, slots=True)
class Unit:
    """A sampler or image: GLSL type, the first texture or image unit it is assigned, and how many it takes."""

    type: str
    unit: int
    count: int

    @property
    def units(self) -> range:
        """All of them."""
        return range(self.unit, self.unit + self.count)


@dataclass(frozen=True, slots=True)
class Block:
    """A uniform or storage block: its binding point and the smallest buffer (one element for open-ended arrays)."""

    binding: int
    bytes: int


@dataclass(frozen=True, slots=True)
class Interface:
    """Everything a program declares and uses, by name (arrays without ``[0]``)."""

    uniforms: dict[str, Uniform]
    samplers: dict[str, Unit]
    images: dict[str, Unit]
    uniform_blocks: dict[str, Block]
    storage_blocks: dict[str, Block]
    attributes: dict[str, int]
    outputs: dict[str, int]  # an array's later elements as name[1], name[2]
    unsupported: tuple[str, ...]  # uniforms of types no graph can set (double)


def reflect(gl: GL, program: int) -> Interface:
    """Read a program's interface and give samplers, images and blocks their units and bindings, in order of name."""
    uniforms: dict[str, Uniform] = {}
    opaque: dict[str, Uniform] = {}
    unsupported = []
    for name, (type_, location, count, block) in _resources(
        gl, program, e.UNIFORM, (e.TYPE, e.LOCATION, e.ARRAY_SIZE, e.BLOCK_INDEX)
    ).items():
        if block != -1 or location == -1:
            continue
        if type_ in _OPAQUE:
            opaque[name] = Uniform(_OPAQUE[type_], location, count)
        elif type_ in _PLAIN:
            uniforms[name] = Uniform(_PLAIN[type_], location, count)
        else:
            unsupported.append(name)
    return Interface(
        uniforms,
        _assign(gl, program, {n: u for n, u in opaque.items() if "sampler" in u.type}),
        _assign(gl, program, {n: u for n, u in opaque.items() if "image" in u.type}),
        _bind(gl, program, e.UNIFORM_BLOCK, "glUniformBlockBinding"),
        _bind(gl, program, e.SHADER_STORAGE_BLOCK, "glShaderStorageBlockBinding"),
        {n: v[0] for n, v in _resources(gl, program, e.PROGRAM_INPUT, (e.LOCATION,)).items() if v[0] >= 0},
        {
            f"{name}[{element}]" if element else name: location + element
            for name, (location, count) in _resources(gl, program, e.PROGRAM_OUTPUT, (e.LOCATION, e.ARRAY_SIZE)).items()
            for element in range(count)
            if location >= 0
        },
        tuple(unsupported),
    )


def _resources(gl: GL, program: int, interface: int, properties: tuple[int, ...]) -> dict[str, tuple[int, ...]]:
    """Name -> values of ``properties``, sorted by name: drivers enumerate in different orders."""
    count, longest = ctypes.c_int(), ctypes.c_int()
    gl.glGetProgramInterfaceiv(program, interface, e.ACTIVE_RESOURCES, ctypes.byref(count))
    gl.glGetProgramInterfaceiv(program, interface, e.MAX_NAME_LENGTH, ctypes.byref(longest))
    text = ctypes.create_string_buffer(max(1, longest.value))
    wanted = (ctypes.c_uint * len(properties))(*properties)
    values = (ctypes.c_int * len(properties))()
    found = {}
    for index in range(count.value):
        gl.glGetProgramResourceName(program, interface, index, len(text), None, text)
        gl.glGetProgramResourceiv(program, interface, index, len(wanted), wanted, len(values), None, values)
        found[text.value.decode().removesuffix("[0]")] = tuple(values)
    return dict(sorted(found.items()))


def _assign(gl: GL, program: int, opaque: dict[str, Uniform]) -> dict[str, Unit]:
    units: dict[str, Unit] = {}
    first = 0
    for name, uniform in opaque.items():
        numbers = (ctypes.c_int * uniform.count)(*range(first, first + uniform.count))
        gl.glProgramUniform1iv(program, uniform.location, uniform.count, numbers)
        units[name] = Unit(uniform.type, first, uniform.count)
        first += uniform.count
    return units


def _bind(gl: GL, program: int, interface: int, binding: str) -> dict[str, Block]:
    blocks: dict[str, Block] = {}
    for number, (name, (size,)) in enumerate(_resources(gl, program, interface, (e.BUFFER_DATA_SIZE,)).items()):
        spelled = name.encode()
        index = gl.glGetProgramResourceIndex(program, interface, spelled)
        getattr(gl, binding)(program, index, number)
        blocks[name] = Block(number, size)
    return blocks


def _plain() -> dict[int, str]:
    names = {0x1406: "float", 0x1404: "int", 0x1405: "uint", 0x8B56: "bool"}
    for first, prefix in ((0x8B50, "vec"), (0x8B53, "ivec"), (0x8DC6, "uvec"), (0x8B57, "bvec")):
        names |= {first + i: f"{prefix}{i + 2}" for i in range(3)}
    return names | {0x8B5A: "mat2", 0x8B5B: "mat3", 0x8B5C: "mat4"}


def _opaque() -> dict[int, str]:
    names = {
        0x8B5D: "sampler1D", 0x8B5E: "sampler2D", 0x8B5F: "sampler3D", 0x8B60: "samplerCube", 0x8B61: "sampler1DShadow",
        0x8B62: "sampler2DShadow", 0x8B63: "sampler2DRect", 0x8B64: "sampler2DRectShadow", 0x8DC0: "sampler1DArray",
        0x8DC1: "sampler2DArray", 0x8DC2: "samplerBuffer", 0x8DC3: "sampler1DArrayShadow",
        0x8DC4: "sampler2DArrayShadow", 0x8DC5: "samplerCubeShadow", 0x8DC9: "isampler1D", 0x8DCA: "isampler2D",
        0x8DCB: "isampler3D", 0x8DCC: "isamplerCube", 0x8DCE: "isampler1DArray", 0x8DCF: "isampler2DArray",
        0x8DD0: "isamplerBuffer", 0x8DD1: "usampler1D", 0x8DD2: "usampler2D", 0x8DD3: "usampler3D",
        0x8DD4: "usamplerCube", 0x8DD6: "usampler1DArray", 0x8DD7: "usampler2DArray", 0x8DD8: "usamplerBuffer",
        0x900C: "samplerCubeArray", 0x900D: "samplerCubeArrayShadow", 0x900E: "isamplerCubeArray",
        0x900F: "usamplerCubeArray", 0x9108: "sampler2DMS", 0x9109: "isampler2DMS", 0x910A: "usampler2DMS",
        0x910B: "sampler2DMSArray", 0x910C: "isampler2DMSArray", 0x910D: "usampler2DMSArray",
    }  # fmt: skip
    shapes = ("1D", "2D", "3D", "2DRect", "Cube", "Buffer", "1DArray", "2DArray", "CubeArray", "2DMS", "2DMSArray")
    for first, prefix in ((0x904C, ""), (0x9057, "i"), (0x9062, "u")):
        names |= {first + i: f"{prefix}image{shape}" for i, shape in enumerate(shapes)}
    return names


_PLAIN: Final = _plain()
_OPAQUE: Final = _opaque()
