"""What plants and their users compute with: molds, CL data, removal, burrs, contours."""
