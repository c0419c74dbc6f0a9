"""What an identification says: summary, pictures, terminal."""
