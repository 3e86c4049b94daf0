"""What training frames are worth."""
