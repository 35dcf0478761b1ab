"""H-infinity and H2 synthesis with certificates, in continuous and discrete time."""

from gainsay.systems.synthesis.gamma import hinf_least_level
from gainsay.systems.synthesis.h2 import h2_output_feedback, h2_state_feedback
from gainsay.systems.synthesis.hinf import hinf_output_feedback, hinf_state_feedback
from gainsay.systems.synthesis.least_h2 import h2_least
from gainsay.systems.synthesis.plant import StandardPlant, Synthesis

__all__ = [
    "StandardPlant",
    "Synthesis",
    "h2_least",
    "h2_output_feedback",
    "h2_state_feedback",
    "hinf_least_level",
    "hinf_output_feedback",
    "hinf_state_feedback",
]
