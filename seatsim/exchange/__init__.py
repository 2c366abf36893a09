"""Models and controllers for other programs: functional mock-up units, C sources, MAT files."""
