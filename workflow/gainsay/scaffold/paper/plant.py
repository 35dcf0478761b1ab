"""The physics of the paper, (1) and (2), as formulas over the tables, which the checker evaluates exactly."""

LOOP = {
    "A": "[[0, 1], [0, 0]]",
    "B": "[[0], [1 / number('J')]]",
    "K": "printed('K')",
    "Acl": "A - B@K",
}
