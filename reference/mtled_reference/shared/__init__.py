"""What both codes share: case files, materials, selections, results and their files."""
