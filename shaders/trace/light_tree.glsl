// Chooses one of many lights by a binary tree (viewer/trace/scene/light_tree.py): from the root on, one of two groups,
// in proportion to about how much of its light arrives.
#include "trace/light_bounds.glsl"

const uint LIGHT_LEAF = 1u << 31; // in the link of a single light

uniform int u_light_tree; // the nodes: pairs of siblings, those of the root first

LightBounds light_node(int node) {
    return light_bounds(u_light_tree + LIGHT_NODE_TEXELS * node);
}

// Returns the number of a light, or -1 where it turns out that no light of a group arrives, with the probability of the
// choice. Levels take the two numbers in turn, so that both keep enough digits; they stay in [0, 1) and independent of
// the choice.
int choose_in_tree(Receiver r, inout vec2 u, out float probability) {
    probability = 1.0;
    int pair = 0;
    for (int level = 0; level < MOST_LIGHT_LEVELS; ++level) {
        LightBounds a = light_node(2 * pair), b = light_node(2 * pair + 1);
        float x = light_importance(a, r), y = light_importance(b, r);
        if (!(x + y > 0.0)) break;
        float first = x / (x + y);
        bool is_first = u.x < first;
        float chance = is_first ? first : y / (x + y);
        u = vec2(u.y, min((is_first ? u.x : u.x - first) / max(chance, 1e-30), 1.0 - 1.0 / 16777216.0));
        probability *= chance;
        uint link = is_first ? a.link : b.link;
        if ((link & LIGHT_LEAF) != 0u) return int(link & ~LIGHT_LEAF);
        pair = int(link);
    }
    probability = 0.0;
    return -1;
}

// The probability with which choose_in_tree chooses the light to which `trail` leads: bit k is the choice at level k.
float probability_in_tree(Receiver r, uint trail) {
    float probability = 1.0;
    int pair = 0;
    for (int level = 0; level < MOST_LIGHT_LEVELS; ++level) {
        LightBounds a = light_node(2 * pair), b = light_node(2 * pair + 1);
        float x = light_importance(a, r), y = light_importance(b, r);
        bool is_first = (trail >> uint(level) & 1u) == 0u;
        float chosen = is_first ? x : y;
        if (!(chosen > 0.0)) return 0.0;
        probability *= chosen / (x + y);
        uint link = is_first ? a.link : b.link;
        if ((link & LIGHT_LEAF) != 0u) return probability;
        pair = int(link);
    }
    return 0.0;
}
