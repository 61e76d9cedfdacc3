"""What geographic programs use: grids of heights, polygons and lines on a map."""
