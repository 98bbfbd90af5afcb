//! Edits carried over to a scene that has changed beneath them.

use crate::scene::description::SceneDescription;

/// `beneath`, but for all parts in which `edited` differs from `before`.
pub(super) fn with_edits(
    before: &SceneDescription,
    edited: &SceneDescription,
    beneath: &SceneDescription,
) -> SceneDescription {
    fn one<T: Clone + PartialEq>(before: &T, edited: &T, beneath: &T) -> T {
        if edited == before { beneath.clone() } else { edited.clone() }
    }
    fn each<T: Clone + PartialEq>(before: &[T], edited: &[T], beneath: &[T]) -> Vec<T> {
        if edited == before {
            return beneath.to_vec();
        }
        let entry = |(i, own): (usize, &T)| match (before.get(i), beneath.get(i)) {
            (Some(before), Some(beneath)) => one(before, own, beneath),
            (None, _) | (_, None) => own.clone(),
        };
        edited.iter().enumerate().map(entry).collect()
    }
    SceneDescription {
        render: one(&before.render, &edited.render, &beneath.render),
        camera: one(&before.camera, &edited.camera, &beneath.camera),
        tone_mapping: one(&before.tone_mapping, &edited.tone_mapping, &beneath.tone_mapping),
        environment: one(&before.environment, &edited.environment, &beneath.environment),
        textures: each(&before.textures, &edited.textures, &beneath.textures),
        materials: each(&before.materials, &edited.materials, &beneath.materials),
        lights: each(&before.lights, &edited.lights, &beneath.lights),
        objects: each(&before.objects, &edited.objects, &beneath.objects),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::Document;
    use crate::io::scene_file::parse;

    const TEXT: &str = "\
        camera = { eye = [0, 1, 5], target = [0, 1, 0] }\n\
        [[objects]]\nname = 'ball'\ntype = 'sphere'\ncenter = [0, 0, 0]\nradius = 1\n\
        [[objects]]\nname = 'ground'\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\n\
        [[lights]]\ntype = 'point'\nposition = [0, 9, 0]\npower = [1, 1, 1]\n";

    fn scene(text: &str) -> SceneDescription {
        parse(text, &[]).unwrap()
    }

    /// Each part is edited, or moved beneath the edits, or both, or neither.
    #[test]
    fn edits_stay_above_a_scene_that_changes_beneath_them() {
        let parts = [
            ("eye = [0, 1, 5]", "eye = [0, 1, 6]", "eye = [0, 1, 7]"),
            ("radius = 1", "radius = 2", "radius = 3"),
            ("point = [0, 0, 0]", "point = [0, -1, 0]", "point = [0, -2, 0]"),
            ("position = [0, 9, 0]", "position = [0, 8, 0]", "position = [0, 7, 0]"),
        ];
        for choice in 0..1_usize << (2 * parts.len()) {
            let (mut edited, mut beneath, mut expected) =
                (TEXT.to_owned(), TEXT.to_owned(), TEXT.to_owned());
            for (part, (before, own, other)) in parts.iter().enumerate() {
                let (is_edited, is_moved) =
                    (choice >> (2 * part) & 1 == 1, choice >> (2 * part) & 2 == 2);
                if is_moved {
                    beneath = beneath.replace(before, other);
                    expected = expected.replace(before, other);
                }
                if is_edited {
                    edited = edited.replace(before, own);
                    expected = expected.replace(if is_moved { other } else { before }, own);
                }
            }
            let mut document = Document::new(scene(TEXT), None);
            document.description = scene(&edited);
            document.rebase(scene(&beneath));
            assert_eq!(document.description, scene(&expected), "choice {choice}");
            assert_eq!(document.is_dirty(), expected != beneath, "choice {choice}");
            let is_other = expected != edited;
            assert_eq!(document.undo().as_deref() == Some("reload"), is_other, "choice {choice}");
            document.redo();
            assert_eq!(document.description, scene(&expected), "choice {choice}, done again");
        }
        let mut document = Document::new(scene(TEXT), None);
        document.description.objects.remove(1);
        document.rebase(scene(&TEXT.replace("radius = 1", "radius = 3")));
        assert_eq!(document.description.objects.len(), 1, "what was taken away comes back");
        assert_eq!(
            document.description.objects[0].radius,
            Some(3.0),
            "what is left is the old one"
        );
    }
}
