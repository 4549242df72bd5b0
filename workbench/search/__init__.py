"""Search by goals: designs proposed, judged cheapest check first, and the best of them shown."""
