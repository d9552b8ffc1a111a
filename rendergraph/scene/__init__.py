"""Scenes: glTF and procedural geometry, materials, lights, cameras, and the scene's feature set."""
