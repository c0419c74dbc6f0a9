"""What a diagnosis says: result, figures, page, terminal."""
