"""Pictures: tone mapping and display, image files, OpenEXR."""
