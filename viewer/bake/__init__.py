"""What is worked out once from an environment or a BRDF and then only looked up. numpy alone, no OpenGL."""
