// As many random numbers as a loop needs, from a counter: for decisions whose number is not known beforehand. Others
// use sample/sobol.glsl, whose numbers are stratified.
#include "sample/sobol.glsl"

// In [0, 1)
float random_number(inout uint counter) {
    return float(hash(++counter) >> 8u) * exp2(-24.0);
}
