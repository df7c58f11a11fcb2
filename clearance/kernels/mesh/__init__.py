"""A polyhedron in the form that kernels read: faces, planes, normal cones, the bounding tree."""
