"""glTF 2.0: reading, checking and decoding (Khronos glTF 2.0 specification, ISO/IEC 12113)."""

from rendergraph.scene.gltf.load import load_gltf

__all__ = ["load_gltf"]
