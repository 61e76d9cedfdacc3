"""The record of a run: fields, the files of a folder, writing and reading them."""
