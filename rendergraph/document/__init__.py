"""The YAML language: models, positions, messages and the JSON Schema."""
