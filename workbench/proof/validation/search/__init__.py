"""The search by goals beside Sobol, random and TPE, on two real problems evaluated 400 times."""
