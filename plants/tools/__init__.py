"""Tools for plants and their users: molds, CL data, removal, burrs, contours."""
