"""One axis of a satellite under state feedback: a worked example, to be replaced by the paper at hand."""
