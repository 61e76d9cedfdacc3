"""doseki for Python programs: what `import doseki` gives."""
