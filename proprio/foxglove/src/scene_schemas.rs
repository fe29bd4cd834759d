//! Schemas of the messages for 3D panels: those of ROS 2 Humble and later.

use proprio_session::recording::schema::{HEADER, POINT, POSE, QUATERNION, Schema, TIME};

const VECTOR3: (&str, &str) = ("geometry_msgs/Vector3", include_str!("definitions/Vector3.msg"));

pub static TF_MESSAGE: Schema = Schema {
    name: "tf2_msgs/msg/TFMessage",
    definition: include_str!("definitions/TFMessage.msg"),
    needs: &[
        ("geometry_msgs/TransformStamped", include_str!("definitions/TransformStamped.msg")),
        ("geometry_msgs/Transform", include_str!("definitions/Transform.msg")),
        VECTOR3,
        QUATERNION,
        HEADER,
        TIME,
    ],
};

pub static MARKER_ARRAY: Schema = Schema {
    name: "visualization_msgs/msg/MarkerArray",
    definition: include_str!("definitions/MarkerArray.msg"),
    needs: &[
        ("visualization_msgs/Marker", include_str!("definitions/Marker.msg")),
        ("visualization_msgs/UVCoordinate", include_str!("definitions/UVCoordinate.msg")),
        ("visualization_msgs/MeshFile", include_str!("definitions/MeshFile.msg")),
        ("sensor_msgs/CompressedImage", include_str!("definitions/CompressedImage.msg")),
        ("std_msgs/ColorRGBA", include_str!("definitions/ColorRGBA.msg")),
        ("builtin_interfaces/Duration", include_str!("definitions/Duration.msg")),
        POSE,
        POINT,
        VECTOR3,
        QUATERNION,
        HEADER,
        TIME,
    ],
};
