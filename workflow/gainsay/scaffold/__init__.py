"""What `gainsay new` writes: a worked example of a paper, and the files of a project around papers."""
