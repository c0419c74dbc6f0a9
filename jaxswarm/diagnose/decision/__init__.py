"""What a candidate is worth on unseen data, how candidates compete, what stays unexplained."""
