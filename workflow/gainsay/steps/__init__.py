"""The steps of the workflow, each `python -m gainsay.steps.<step> <paper>`: files in, files out."""

import gc
import os

# Modules and a step make many objects that last: Python would look for cycles among them again and again.
gc.set_threshold(100_000, 20, 50)
# Numeric libraries read these when they are first imported. One thread each: results are then the same to the byte, and
# two jobs share two cores better than two thread pools do.
for _variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "RAYON_NUM_THREADS"):
    os.environ.setdefault(_variable, "1")
