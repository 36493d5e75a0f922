"""The page that shows a case to people who read: one HTML file with results, figures and instruments that compute."""
