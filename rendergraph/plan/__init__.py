"""From a document to a verified plan: pure Python, one phase a file, no OpenGL."""
