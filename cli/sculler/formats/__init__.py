"""The project's own files: logs, vectors, truth, navigation results, where a file comes from."""
