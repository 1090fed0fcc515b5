"""Many runs: the cases of a study, on worker processes or a cluster, and what came of them."""
