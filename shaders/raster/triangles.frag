// The number of the triangle that each sample shows.
uniform uint u_first_triangle;

out uint o_triangle;

void main() {
    o_triangle = u_first_triangle + uint(gl_PrimitiveID);
}
